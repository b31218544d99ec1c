// The watchdog.
#include "hal/avr/watchdog.h"

#include <avr/interrupt.h>
#include <avr/wdt.h>

#include "hal/avr/motors.h"
#include "hal/avr/reset_cause.h"

namespace screed {
namespace avr {
namespace {

constexpr uint8_t kMostLooks = 6;  // 60 ms

volatile uint8_t looks;  // since the last feed

}  // namespace

void watchdog_init() {
  wdt_enable(WDTO_120MS);
}

void watchdog_feed() {
  wdt_reset();
  looks = 0;
}

// Not the watchdog's own interrupt: as long as that one is pending the hardware does not reset, so
// a program that hangs with its interrupts off would hang for ever.
void watchdog_look() {
  const uint8_t now = static_cast<uint8_t>(looks + 1);
  if (now < kMostLooks) {
    looks = now;
    return;
  }
  motors_off();
  reset_will_be(ResetCause::kWatchdog);
}

void watchdog_reset_now() {
  cli();
  motors_off();
  wdt_enable(WDTO_15MS);
  for (;;) {
  }
}

}  // namespace avr
}  // namespace screed
