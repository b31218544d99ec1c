// The robot. The library takes the whole microcontroller: timers 1 and 3, I2C, USART1, ADC, EEPROM,
// watchdog and all three LEDs. Choose the board "Pololu A-Star 32U4" (a Zumo 32U4 is one as well).
#include <Screed.h>

void setup() {
  screed::main_loop();  // never returns
  for (;;) {
  }
}

void loop() {}
