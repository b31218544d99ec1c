# The firmware as an Arduino library. Included by the top Makefile after hal/avr/firmware.mk.
#
#   make arduino [BOARD=...]   build/arduino/Screed-<version>.zip, for "Sketch > Include Library > Add .ZIP Library"
#
# The tests unpack it, build its example as the IDE would, and run that in the simulator.

ARDUINO_ZIP := $(BUILD_ROOT)/arduino/Screed-$(VERSION).zip
ARDUINO_TEST_ELF := $(BUILD_ROOT)/arduino/example.elf
ARDUINO_PACKED := $(wildcard tools/arduino/*) LICENSE hal/hal.h hal/sample.h $(wildcard firmware/*.* firmware/*/*.* nn/infer/*.* hal/avr/*.* boards/*/*.h) \
  $(GENERATED_FOLDER)/schema/messages.h

.PHONY: arduino arduino-library
arduino: deps
	$(STEP) arduino-library
arduino-library: $(ARDUINO_ZIP)
	@echo "$(ARDUINO_ZIP)"

$(ARDUINO_ZIP): $(ARDUINO_PACKED)
	@SMALLER="$(SMALLER)" tools/arduino/pack.sh $(BOARD) $(VERSION) $(GENERATED_FOLDER) $@

$(ARDUINO_TEST_ELF): $(ARDUINO_ZIP) tools/arduino/build.sh
	@echo "  IDE  $@"
	@tools/arduino/build.sh $< $@
TEST_IMAGES += $(ARDUINO_TEST_ELF)
