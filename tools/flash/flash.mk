# The image onto the board, the board's fuses, a serial monitor. Included by the top Makefile after
# hal/avr/firmware.mk.
#
# Needs hal/avr/firmware.mk and tests/tests.mk; adds to TESTS and TEST_IMAGES.

# Of a board; its board.mk may say otherwise. Ids and fuses of Pololu's boards with an ATmega32U4: boards.txt
# and bootloaders/caterina/Caterina-A-Star.txt of github.com/pololu/a-star.
BOARD_USB_VID ?= 0x1FFB
BOARD_USB_PID ?= 0x2300
BOARD_BOOTLOADER_USB_PID ?= 0x0101
BOARD_FUSE_LOW ?= 0xFF
BOARD_FUSE_HIGH ?= 0xD0
BOARD_FUSE_EXTENDED ?= 0xC8
BOARD_LOCK ?= 0xEF

PORT ?=
PROGRAMMER ?=
WRITE ?= no

FLASH_SOURCES := $(call sources,tools/flash)
SCREED_FLASH := $(B)/screed_flash
FLASH_BOARD = --sketch-usb $(BOARD_USB_VID:0x%=%):$(BOARD_USB_PID:0x%=%) \
  --bootloader-usb $(BOARD_USB_VID:0x%=%):$(BOARD_BOOTLOADER_USB_PID:0x%=%) $(if $(PORT),--port '$(PORT)')

.PHONY: flash fuses monitor
$(SCREED_FLASH): $(call objects,$(FLASH_SOURCES)) $(COMMAND_LINE)
	@echo "  LINK $@"
	@$(CXX) $(filter -fsanitize%,$(OPTIMISE_$(BUILD))) $^ -pthread -o $@
	$(call runnable,$@)

# `firmware` also checks the budget: an image that reaches into the bootloader is not flashed.
flash: $(SCREED_FLASH) firmware  ## build it and bring it onto the board (BOARD=NAME PORT=/dev/ttyACM0)
	@$(SCREED_FLASH) write $(FIRMWARE_BUILD)/screed.hex --mcu $(BOARD_MCU) $(FLASH_BOARD) $(ARGS)
fuses: $(SCREED_FLASH)  ## the fuses the board should have (PROGRAMMER=avr109|NAME: compare; WRITE=yes: write)
	@$(SCREED_FLASH) fuses --mcu $(BOARD_MCU) $(FLASH_BOARD) --low $(BOARD_FUSE_LOW) --high $(BOARD_FUSE_HIGH) \
	  --extended $(BOARD_FUSE_EXTENDED) --lock $(BOARD_LOCK) $(if $(PROGRAMMER),--programmer '$(PROGRAMMER)') \
	  $(if $(filter yes,$(WRITE)),--write) $(ARGS)
# The console of the firmware neither echoes nor ends its lines with a carriage return (hal/avr/console.cpp).
monitor: $(SCREED_FLASH)  ## serial monitor on the board (PORT=/dev/ttyACM0)
	@command -v tio > /dev/null || { echo "make monitor: tio is not installed: make deps, or apt install tio" >&2; exit 1; }
	@port=$$($(SCREED_FLASH) port $(FLASH_BOARD)) && exec tio --local-echo --map INLCRNL,ONLCRNL $(ARGS) "$$port"

# ---- tests: avrdude against a stand-in for the bootloader ------------------------------------------------------------------

FLASH_TESTS := $(B)/tests/flash_tests
FLASH_TEST_SOURCES := $(call sources,tests/flash)
TESTS += $(FLASH_TESTS)
$(eval $(call in_groups,FLASH,$(FLASH_TEST_SOURCES),test))
TEST_IMAGES += $(SCREED_FLASH) $(FIRMWARE_BUILD)/screed.hex
test: export SCREED_FLASH_PROGRAM := $(abspath $(SCREED_FLASH))
test: export SCREED_FLASH_IMAGE := $(abspath $(FIRMWARE_BUILD))/screed.hex

$(FLASH_TESTS): $(FLASH_OBJECTS) $(call objects,$(filter-out tools/flash/main.cpp,$(FLASH_SOURCES)))
	@echo "  LINK $@"
	@$(CXX) $(filter -fsanitize%,$(OPTIMISE_$(BUILD))) $^ -pthread $(TEST_LIBRARIES) -o $@
	$(call runnable,$@)
