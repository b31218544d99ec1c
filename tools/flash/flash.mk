# The image onto the board, the board's fuses, a serial monitor. Included by the top Makefile after
# hal/avr/firmware.mk.
#
#   make flash   [BOARD=...] [PORT=...]                     builds, finds the board, writes, verifies
#   make fuses   [PROGRAMMER=...] [PORT=...] [WRITE=yes]    prints the fuses, compares them, writes them
#   make monitor [PORT=...]                                 serial monitor
#
# Needs from there: B, BOARD, ARGS, FIRMWARE_BUILD, BOARD_MCU, STEP, objects, host.flags, TESTS, TEST_IMAGES, TIDY_SOURCES.

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

FLASH_SOURCES := $(wildcard tools/flash/*.cpp)
SCREED_FLASH := $(B)/screed_flash
FLASH_BOARD = --sketch-usb $(BOARD_USB_VID:0x%=%):$(BOARD_USB_PID:0x%=%) \
  --bootloader-usb $(BOARD_USB_VID:0x%=%):$(BOARD_BOOTLOADER_USB_PID:0x%=%) $(if $(PORT),--port '$(PORT)')

.PHONY: flash fuses monitor run-flash run-fuses run-monitor
flash: deps
	$(STEP) run-flash
fuses: deps
	$(STEP) run-fuses
monitor: deps
	$(STEP) run-monitor

$(SCREED_FLASH): $(call objects,$(FLASH_SOURCES))
	@echo "  LINK $@"
	@$(CXX) $(filter -fsanitize%,$(OPTIMISE_$(BUILD))) $^ -pthread -o $@

# firmware-image also checks the budget: an image that reaches into the bootloader is not flashed.
run-flash: $(SCREED_FLASH) firmware-image
	@$(SCREED_FLASH) write $(FIRMWARE_BUILD)/screed.hex --mcu $(BOARD_MCU) $(FLASH_BOARD) $(ARGS)
run-fuses: $(SCREED_FLASH)
	@$(SCREED_FLASH) fuses --mcu $(BOARD_MCU) $(FLASH_BOARD) --low $(BOARD_FUSE_LOW) --high $(BOARD_FUSE_HIGH) \
	  --extended $(BOARD_FUSE_EXTENDED) --lock $(BOARD_LOCK) $(if $(PROGRAMMER),--programmer '$(PROGRAMMER)') \
	  $(if $(filter yes,$(WRITE)),--write) $(ARGS)
# The console of the firmware neither echoes nor ends its lines with a carriage return (hal/avr/console.cpp).
run-monitor: $(SCREED_FLASH)
	@command -v tio > /dev/null || { echo "make monitor: tio is not installed: make deps, or apt install tio" >&2; exit 1; }
	@port=$$($(SCREED_FLASH) port $(FLASH_BOARD)) && exec tio --local-echo --map INLCRNL,ONLCRNL $(ARGS) "$$port"

# ---- tests: avrdude against a stand-in for the bootloader ------------------------------------------------------------------

FLASH_TESTS := $(B)/tests/flash_tests
FLASH_TEST_SOURCES := $(wildcard tests/flash/*.cpp)
TESTS += $(FLASH_TESTS)
TEST_IMAGES += $(SCREED_FLASH) $(FIRMWARE_BUILD)/screed.hex
TIDY_SOURCES += $(FLASH_SOURCES) $(FLASH_TEST_SOURCES)
run-tests: export SCREED_FLASH_PROGRAM := $(abspath $(SCREED_FLASH))
run-tests: export SCREED_FLASH_IMAGE := $(abspath $(FIRMWARE_BUILD))/screed.hex

$(FLASH_TESTS): $(call objects,$(FLASH_TEST_SOURCES) $(filter-out tools/flash/main.cpp,$(FLASH_SOURCES)))
	@echo "  LINK $@"
	@$(CXX) $(filter -fsanitize%,$(OPTIMISE_$(BUILD))) $^ -pthread $$(pkg-config --libs $(TEST_PACKAGES)) -o $@

FLASH_OBJECTS := $(call objects,$(FLASH_SOURCES) $(FLASH_TEST_SOURCES))
-include $(FLASH_OBJECTS:.o=.d)
