// Timer1: the PWM of both motors.
#include "hal/avr/motors.h"

#include <avr/io.h>

#include "firmware/math/fixed.h"
#include "hal/avr/interrupts_off.h"
#include "hal/sample.h"
#include "pins.h"

namespace screed {
namespace avr {
namespace {

struct Drive {
  uint16_t duty;
  bool reverse;
};

Drive drive_from(int16_t duty) {
  const uint16_t size = abs_i16(duty);
  return {size > kDutyMax ? static_cast<uint16_t>(kDutyMax) : size, duty < 0};
}

/// The compare registers are double buffered: a new duty counts from the end of the PWM period, 50
/// us at most.
void wait_for_period_end() {
  TIFR1 = _BV(TOV1);
  for (uint8_t tries = 0; tries < UINT8_MAX && (TIFR1 & _BV(TOV1)) == 0; ++tries) {
  }
}

/// Changes the direction of a motor that turns the other way. A motor that stands keeps its
/// direction pin.
template <typename Pin>
bool must_reverse(const Drive& drive) {
  return drive.duty != 0 && drive.reverse != Pin::is_high();
}

}  // namespace

void motors_init() {
  LeftPwmPin::clear();
  RightPwmPin::clear();
  LeftDirectionPin::clear();
  RightDirectionPin::clear();
  LeftPwmPin::make_output();
  RightPwmPin::make_output();
  LeftDirectionPin::make_output();
  RightDirectionPin::make_output();
  ICR1 = kDutyMax;  // 16 MHz / 2 / 400 = 20 kHz
  motors_off();
  TCCR1A = _BV(COM1A1) | _BV(COM1B1);
  TCCR1B = _BV(WGM13) | _BV(CS10);  // phase and frequency correct, top in ICR1, clock / 1
}

void motors_off() {
  {
    const InterruptsOff interrupts_off;
    LEFT_DUTY_REGISTER = 0;
    RIGHT_DUTY_REGISTER = 0;
  }
}

void motors_drive(int16_t left, int16_t right) {
  const Drive left_drive = drive_from(left);
  const Drive right_drive = drive_from(right);
  const bool reverse_left = must_reverse<LeftDirectionPin>(left_drive);
  const bool reverse_right = must_reverse<RightDirectionPin>(right_drive);
  // The old duty must not act in the new direction: duty off, end of the period, direction, new
  // duty.
  if (reverse_left || reverse_right) {
    {
      const InterruptsOff interrupts_off;
      if (reverse_left) LEFT_DUTY_REGISTER = 0;
      if (reverse_right) RIGHT_DUTY_REGISTER = 0;
    }
    wait_for_period_end();
    if (reverse_left) LeftDirectionPin::write(left_drive.reverse);
    if (reverse_right) RightDirectionPin::write(right_drive.reverse);
  }
  // 16-bit registers share one buffer for their high bytes: no interrupt may write one in between.
  {
    const InterruptsOff interrupts_off;
    LEFT_DUTY_REGISTER = left_drive.duty;
    RIGHT_DUTY_REGISTER = right_drive.duty;
  }
}

}  // namespace avr
}  // namespace screed
