// Timer1: the PWM of both motors, 20 kHz, and their direction pins.
#pragma once

#include <stdint.h>

namespace screed {
namespace avr {

/// Motors off; the first thing a program does.
void motors_init();

/// Duty -kDutyMax..kDutyMax, positive forward; limited to that range.
void motors_drive(int16_t left, int16_t right);

/// Duty 0 on both at once. May be called from an interrupt.
void motors_off();

}  // namespace avr
}  // namespace screed
