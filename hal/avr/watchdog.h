// The watchdog: a main loop that hangs for 60 ms loses its motors, and after 60 ms more the whole
// MCU is reset.
#pragma once

namespace screed {
namespace avr {

void watchdog_init();

/// The main loop is alive.
void watchdog_feed();

}  // namespace avr
}  // namespace screed
