// The watchdog: a main loop that hangs for 60 ms loses its motors, and after 120 ms the whole MCU
// is reset. The reset comes in hardware, also when the program hangs with its interrupts off.
#pragma once

namespace screed {
namespace avr {

void watchdog_init();

/// The main loop is alive.
void watchdog_feed();

/// Takes the motors' power from a main loop that hangs; called from an interrupt every 10 ms.
void watchdog_check();

/// Motors off, and the MCU is reset at once. Never returns.
void watchdog_reset_now() __attribute__((noreturn));

}  // namespace avr
}  // namespace screed
