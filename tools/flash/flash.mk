# The image onto the board, the board's fuses, a serial monitor. Included by the top Makefile after
# hal/avr/firmware.mk, which it needs.

PORT ?=
PROGRAMMER ?=
WRITE ?= no

# flash.py knows what Pololu's boards have; a board.mk may say otherwise.
SCREED_FLASH := tools/flash/flash.py
FLASH_BOARD = --sketch-usb $(BOARD_USB_VID:0x%=%):$(BOARD_USB_PID:0x%=%) $(if $(PORT),--port '$(PORT)') \
  $(if $(BOARD_BOOTLOADER_USB_PID),--bootloader-usb $(BOARD_USB_VID:0x%=%):$(BOARD_BOOTLOADER_USB_PID:0x%=%))
FLASH_FUSES = $(BOARD_FUSE_LOW:%=--low %) $(BOARD_FUSE_HIGH:%=--high %) $(BOARD_FUSE_EXTENDED:%=--extended %) \
  $(BOARD_LOCK:%=--lock %)

.PHONY: flash fuses monitor test-flash
# `firmware` also checks the budget: an image that reaches into the bootloader is not flashed.
flash: firmware  ## build it and bring it onto the board (BOARD=NAME PORT=/dev/ttyACM0)
	@$(SCREED_FLASH) write $(FIRMWARE_BUILD)/screed.hex --mcu $(BOARD_MCU) $(FLASH_BOARD) $(ARGS)
fuses:  ## the fuses the board should have (PROGRAMMER=avr109|NAME: compare; WRITE=yes: write)
	@$(SCREED_FLASH) fuses --mcu $(BOARD_MCU) $(FLASH_BOARD) $(FLASH_FUSES) \
	  $(if $(PROGRAMMER),--programmer '$(PROGRAMMER)') $(if $(filter yes,$(WRITE)),--write) $(ARGS)
# The console of the firmware neither echoes nor ends its lines with a carriage return (hal/avr/console.cpp).
monitor:  ## serial monitor on the board (PORT=/dev/ttyACM0)
	@command -v tio > /dev/null || \
	  { echo "make monitor: tio is not installed: make deps, or apt install tio" >&2; exit 1; }
	@port=$$($(SCREED_FLASH) port $(FLASH_BOARD)) && exec tio --local-echo --map INLCRNL,ONLCRNL $(ARGS) "$$port"

test-flash: $(FIRMWARE_BUILD)/screed.hex  ## the flash tool: the real avrdude against a stand-in for the bootloader
	@echo "  TEST tests/flash"
	@SCREED_FLASH_IMAGE=$(abspath $<) python3 -B -m unittest discover -s tests/flash -p '*_test.py'
test: test-flash
