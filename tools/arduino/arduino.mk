# The firmware as an Arduino library. Included by the top Makefile after hal/avr/firmware.mk.
#
#   make arduino [BOARD=...]   build/arduino/Screed-<version>.zip, for "Sketch > Include Library > Add .ZIP Library"
#
# The tests unpack it, build its example as the IDE would, and run that in the simulator.

ARDUINO_ZIP := $(BUILD_ROOT)/arduino/Screed-$(VERSION).zip
ARDUINO_TEST_ELF := $(BUILD_ROOT)/arduino/example.elf
ARDUINO_PACKED := $(wildcard tools/arduino/*) LICENSE \
  $(shell find firmware nn/infer hal boards -name '*.cpp' -o -name '*.h') \
  $(FIRMWARE_SCHEMA_HEADERS)

.PHONY: arduino
arduino: $(ARDUINO_ZIP)  ## the firmware as a library for the Arduino IDE (BOARD=NAME)
	@echo "$(ARDUINO_ZIP)"

$(ARDUINO_ZIP): $(ARDUINO_PACKED)
	@SMALLER="$(SMALLER)" tools/arduino/pack.sh $(BOARD) $(VERSION) $(GENERATED_FOLDER) $@

$(ARDUINO_TEST_ELF): $(ARDUINO_ZIP) tools/arduino/build.sh
	@echo "  IDE  $@"
	@tools/arduino/build.sh $< $@
TEST_IMAGES += $(ARDUINO_TEST_ELF)
