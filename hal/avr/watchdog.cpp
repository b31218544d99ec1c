// The watchdog.
#include "hal/avr/watchdog.h"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/wdt.h>

#include "hal/avr/motors.h"

namespace screed {
namespace avr {

/// After a watchdog reset the watchdog runs on with its shortest time, 15 ms: it has to stop before
/// variables are set up.
extern "C" void screed_stop_watchdog() __attribute__((naked, used, section(".init3")));
extern "C" void screed_stop_watchdog() {
  MCUSR = 0;  // WDRF would keep it running
  wdt_disable();
}

// First time-out. The hardware clears WDIE: the second time-out resets.
ISR(WDT_vect) {
  motors_off();
}

void watchdog_init() {
  wdt_enable(WDTO_60MS);
  watchdog_feed();
}

void watchdog_feed() {
  wdt_reset();
  WDTCSR |= _BV(WDIE);
}

}  // namespace avr
}  // namespace screed
