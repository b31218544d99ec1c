// The watchdog.
#include "hal/avr/watchdog.h"

#include <avr/interrupt.h>
#include <avr/wdt.h>

#include "hal/avr/motors.h"
#include "hal/avr/reset_cause.h"

namespace screed {
namespace avr {
namespace {

constexpr uint8_t kMaxLooks = 6;  // 60 ms

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
void watchdog_check() {
  const uint8_t now = static_cast<uint8_t>(looks + 1);
  if (now < kMaxLooks) {
    looks = now;
    return;
  }
  motors_off();
  set_next_reset_cause(ResetCause::kWatchdog);
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
