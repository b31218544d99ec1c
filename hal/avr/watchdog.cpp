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
  // A main loop that comes back has not been reset.
  if (looks == kMaxLooks) set_next_reset_cause(ResetCause::kExternal);
  looks = 0;
}

// Not the watchdog's own interrupt: as long as that one is pending the hardware does not reset, so
// a program that hangs with its interrupts off would hang for ever.
void watchdog_check() {
  const uint8_t now = looks;
  if (now < kMaxLooks) looks = static_cast<uint8_t>(now + 1);
  if (now + 1 < kMaxLooks) return;
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
