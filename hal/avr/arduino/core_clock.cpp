// What the Arduino core has of clocks in its wiring.c, in less flash: the core's main() calls
// init(), its USB code delay().
//
// The core's own init() starts every timer for analogWrite() and interrupts 1000 times a second for
// millis(); here the drivers set up the timers they use, and nothing asks for the time. Weak: a
// sketch that calls millis() brings in the core's.
#include <Arduino.h>
#include <util/delay.h>

/// Interrupts stay off until hal::init() has set up what they serve.
__attribute__((weak)) void init() {}

/// Busy. The core asks for at most 10 ms.
__attribute__((weak)) void delay(unsigned long ms) {
  while (ms-- != 0) _delay_ms(1);
}
