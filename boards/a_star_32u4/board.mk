# Pololu A-Star 32U4 Robot Controller: what the build has to know.
BOARD_MCU := atmega32u4
BOARD_CLOCK_HZ := 16000000
