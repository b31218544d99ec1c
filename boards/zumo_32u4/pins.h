// Pololu Zumo 32U4: which pin does what. For hal/avr only.
// Source: Pololu's library for the robot (github.com/pololu/zumo-32u4-arduino-library: Motors,
// Encoders, Buttons) and its "Zumo 32U4 User's Guide" 3.
#pragma once

#include "boards/common/pololu_32u4_pins.h"
#include "hal/avr/chip_axis.h"
#include "hal/avr/pin.h"
#include "hal/avr/quadrature.h"

namespace screed {
namespace avr {

// Motors. A high direction pin is reverse.
using LeftPwmPin = Pin<kPortB, 6>;         // pin 10
using LeftDirectionPin = Pin<kPortB, 2>;   // pin 16
using RightPwmPin = Pin<kPortB, 5>;        // pin 9
using RightDirectionPin = Pin<kPortB, 1>;  // pin 15
#define LEFT_DUTY_REGISTER OCR1B
#define RIGHT_DUTY_REGISTER OCR1A

// Encoders: (A xor B) on the pin with the interrupt, which so sees the edges of both channels, and
// B. One interrupt a side. A leads B when the track drives forward.
using LeftEncoderXor = Pin<kPortB, 4>;   // pin 8, PCINT4
using LeftEncoderB = Pin<kPortE, 2>;     // on no Arduino pin
using RightEncoderXor = Pin<kPortE, 6>;  // pin 7, INT6
using RightEncoderB = Pin<kPortF, 0>;    // pin 23
#define SCREED_RIGHT_ENCODER_ON_INT6

inline QuadratureLevels read_left_encoder() {
  return levels_from_xor(LeftEncoderXor::is_high(), LeftEncoderB::is_high());
}
inline QuadratureLevels read_right_encoder() {
  return levels_from_xor(RightEncoderXor::is_high(), RightEncoderB::is_high());
}

inline void make_encoder_pins_inputs() {
  LeftEncoderXor::set();  // pull-ups
  LeftEncoderB::set();
  RightEncoderXor::set();
  RightEncoderB::set();
}

// Of a tick, both sides; 114 come at three times the full speed.
constexpr uint8_t kMaxEncoderEdges = 150;

inline void enable_encoder_interrupts() {
  PCMSK0 = LeftEncoderXor::kMask;
  PCIFR = _BV(PCIF0);
  PCICR = _BV(PCIE0);
  EICRB = _BV(ISC60);  // any edge
  EIFR = _BV(INTF6);
  EIMSK = _BV(INT6);
}
inline void disable_encoder_interrupts() {
  PCICR = 0;
  EIMSK = 0;
}

constexpr bool kHasBarometer = false;

// LSM303D and L3GD20H lie on the main board with x forward, y left, z up: Pololu's example
// "Balancing" takes -a.x for up while the robot stands on its nose, and g.y > 0 for nose down. (The
// comment in "FaceUphill" has the sign of x the other way round; its code does not use x.)
constexpr ChipAxis kImuAxes[3] = {{0, false}, {1, false}, {2, false}};

}  // namespace avr
}  // namespace screed
