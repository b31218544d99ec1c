// Pololu A-Star 32U4 Robot Controller on a Dagu Rover 5: which pin does what. For hal/avr only.
// Source: Pololu, "A-Star 32U4 User's Guide" 6, and the schematic of the robot controller.
#pragma once

#include "boards/common/pololu_32u4_pins.h"
#include "hal/avr/chip_axis.h"
#include "hal/avr/pin.h"
#include "hal/avr/quadrature.h"

namespace screed {
namespace avr {

// Motors. M1 drives the left track, M2 the right one. A high direction pin is reverse.
using LeftPwmPin = Pin<kPortB, 5>;        // pin 9
using LeftDirectionPin = Pin<kPortD, 6>;  // pin 12
using RightPwmPin = Pin<kPortB, 6>;       // pin 10
using RightDirectionPin = Pin<kPortE, 2>;
#define LEFT_DUTY_REGISTER OCR1A
#define RIGHT_DUTY_REGISTER OCR1B

// Encoders: both channels of both tracks on port B, one interrupt and one port read. A leads B when
// the track drives forward.
using LeftEncoderA = Pin<kPortB, 4>;   // pin 8
using LeftEncoderB = Pin<kPortB, 7>;   // pin 11
using RightEncoderA = Pin<kPortB, 1>;  // pin 15
using RightEncoderB = Pin<kPortB, 2>;  // pin 16

inline void make_encoder_pins_inputs() {
  LeftEncoderA::set();  // pull-ups: a broken wire is a level that stands still
  LeftEncoderB::set();
  RightEncoderA::set();
  RightEncoderB::set();
}

/// Both channels of one moment, by one read of the port.
inline QuadratureLevels read_left_encoder() {
  const uint8_t port = PINB;
  return {(port & LeftEncoderA::kMask) != 0, (port & LeftEncoderB::kMask) != 0};
}
inline QuadratureLevels read_right_encoder() {
  const uint8_t port = PINB;
  return {(port & RightEncoderA::kMask) != 0, (port & RightEncoderB::kMask) != 0};
}

// Of a tick, both sides; 26 come at three times the full speed.
constexpr uint8_t kMaxEncoderEdges = 60;

inline void enable_encoder_interrupts() {
  PCMSK0 = LeftEncoderA::kMask | LeftEncoderB::kMask | RightEncoderA::kMask | RightEncoderB::kMask;
  PCIFR = _BV(PCIF0);
  PCICR = _BV(PCIE0);
}
inline void disable_encoder_interrupts() {
  PCICR = 0;
}

constexpr bool kHasBarometer = true;

// The AltIMU-10 v4 lies flat, components up, its printed x arrow forward. Its printed axes hold for
// LSM303D and L3GD20H alike. The accelerometer shows +1 g on the axis that points up, as
// SensorSample wants it.
constexpr ChipAxis kImuAxes[3] = {{0, false}, {1, false}, {2, false}};

}  // namespace avr
}  // namespace screed
