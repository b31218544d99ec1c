// Timer3: the 100 Hz control tick, the time of day, the measured load, and the moment at which the
// IMU is read.
#pragma once

#include <stdint.h>

namespace screed {
namespace avr {

void tick_timer_init();

/// Sleeps until the next tick. A tick that was missed because the computation took too long is left
/// out: time goes on.
void tick_timer_wait();

/// Time of the current tick since tick_timer_init(), a multiple of 10 ms; wraps after 71.6 minutes.
uint32_t tick_timer_time_us();

/// From the timer event of the previous tick to the next call of tick_timer_wait(), interrupts
/// included; stops at 65535.
uint16_t tick_timer_last_us();

}  // namespace avr
}  // namespace screed
