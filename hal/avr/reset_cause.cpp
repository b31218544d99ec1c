// Why the program started.
#include "hal/avr/reset_cause.h"

#include <avr/io.h>
#include <avr/wdt.h>

namespace screed {
namespace avr {
namespace {

// A mark is this plus a ResetCause; all other values are what RAM holds after power-on.
constexpr uint16_t kMark = 0x5CE0;

struct Kept {
  uint8_t flags;  // MCUSR as the bootloader left it
  uint16_t mark;
};
Kept kept __attribute__((section(".noinit")));

ResetCause cause = ResetCause::kPowerOn;

bool marked() {
  return (kept.mark & 0xFFF0U) == kMark;
}

}  // namespace

/// After a watchdog reset the watchdog runs on with its shortest time, 15 ms: it has to stop before
/// variables are set up.
extern "C" void screed_stop_watchdog() __attribute__((naked, used, section(".init3")));
extern "C" void screed_stop_watchdog() {
  kept.flags = MCUSR;
  MCUSR = 0;  // WDRF would keep it running
  wdt_disable();
}

void reset_cause_init() {
  const ResetCause mark = static_cast<ResetCause>(kept.mark & 0x0FU);
  // Without a mark RAM was without power. A supply that rises slowly sets BORF as well as PORF, of
  // which the A-Star's bootloader leaves BORF alone.
  if ((kept.flags & _BV(PORF)) != 0 || !marked()) {
    cause = ResetCause::kPowerOn;
  } else if ((kept.flags & _BV(BORF)) != 0) {
    cause = ResetCause::kBrownOut;
  } else {
    cause = (kept.flags & _BV(WDRF)) != 0 && mark == ResetCause::kExternal ? ResetCause::kWatchdog
                                                                           : mark;
  }
  set_next_reset_cause(ResetCause::kExternal);
}

ResetCause reset_cause() {
  return cause;
}

__attribute__((noinline)) void set_next_reset_cause(ResetCause next) {
  kept.mark = static_cast<uint16_t>(kMark | static_cast<uint8_t>(next));
}

}  // namespace avr
}  // namespace screed
