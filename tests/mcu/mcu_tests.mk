# Tests of the images for the microcontroller in the simulator simavr. Included by tests/tests.mk.
#
# $(B)/tests/mcu_tests runs screed.elf, the image that is flashed, and the images of tests/mcu/images.
# Needs host.mk and hal/avr/firmware.mk; adds to TESTS and TEST_IMAGES.

MCU_TESTS := $(B)/tests/mcu_tests
MCU_TEST_SOURCES := $(wildcard tests/mcu/*.cpp)
MCU_LONG_SOURCES := $(wildcard tests/long/mcu/*.cpp)
$(eval $(call in_groups,MCU,$(MCU_TEST_SOURCES),test,@$(B)/tests/mcu.flags))
$(eval $(call in_groups,MCU_LONG,$(MCU_LONG_SOURCES),test,@$(B)/tests/mcu.flags))
$(MCU_GROUP_OBJECTS) $(MCU_LONG_GROUP_OBJECTS): $(B)/tests/mcu.flags
# The bench and the like, which tests of both programs use.
MCU_BENCH := $(call objects,$(MCU_ALONE))
MCU_LONG_PARTS := $(MCU_LONG_OBJECTS) $(MCU_BENCH)
TESTS += $(MCU_TESTS)

# An image: its main program and what it uses of the firmware's core.
MCU_IMAGES := $(patsubst tests/mcu/images/%.cpp,$(FIRMWARE_BUILD)/%.elf,$(wildcard tests/mcu/images/*.cpp))
MCU_IMAGE_CORE := $(FIRMWARE_STARTUP) \
  $(filter-out %/main_loop.o,$(filter $(FIRMWARE_BUILD)/firmware/% $(FIRMWARE_BUILD)/nn/%,$(FIRMWARE_OBJECTS)))
TEST_IMAGES += $(MCU_IMAGES) $(FIRMWARE_ELF) $(FIRMWARE_BUILD)/screed.lst $(FIRMWARE_BUILD)/screed.size

$(MCU_IMAGES): $(FIRMWARE_BUILD)/%.elf: $(FIRMWARE_BUILD)/tests/mcu/images/%.o $(MCU_IMAGE_CORE)
	@echo "  LINK $@"
	@$(AVR_CXX) $(AVR_FLAGS) $(AVR_WARNINGS) $(AVR_LINK) $^ -o $@

# Models as headers for the microcontroller.
$(FIRMWARE_BUILD)/generated/models/%.h: nn/models/%.json $(SCREED)
	@mkdir -p $(@D)
	@$(SCREED) nn export $< --header $@
$(FIRMWARE_BUILD)/tests/mcu/images/model.o: $(FIRMWARE_BUILD)/generated/models/v1.h

$(B)/tests/mcu.flags: FORCE
	@mkdir -p $(@D)
	@echo "-Iboards/$(BOARD) -DSCREED_IMAGE_FOLDER='\"$(abspath $(FIRMWARE_BUILD))\"' \
	  -DSCREED_WIRING='\"$(abspath boards/$(BOARD)/wiring.ini)\"'" | $(WRITE_CHANGED)

$(call objects,$(MCU_TEST_SOURCES) $(MCU_LONG_SOURCES)): $(B)/%.o: %.cpp $(B)/host.flags $(B)/tests/mcu.flags | \
  $(GENERATED)
	@mkdir -p $(@D)
	@echo "  CXX  $<"
	@$(CXX) @$(B)/host.flags @$(B)/tests/mcu.flags $(HEADERS_FLAGS) $(SET_FLAGS) -MMD -MP -c $< -o $@

$(MCU_TESTS): $(MCU_OBJECTS) $(LIBRARY) $(B)/libavr_tools.a $(B)/link.flags
	$(call link_tests)
