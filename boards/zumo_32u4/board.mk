# Pololu Zumo 32U4: what the build has to know.
BOARD_MCU := atmega32u4
BOARD_CLOCK_HZ := 16000000
# Pololu's boards.txt knows it as an A-Star 32U4, bootloader and all.
BOARD_USB_VID := 0x1FFB
BOARD_USB_PID := 0x2300
BOARD_USB_MANUFACTURER := Pololu Corporation
BOARD_USB_PRODUCT := Pololu A-Star 32U4
