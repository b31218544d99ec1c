// Both track encoders, counted by pin interrupts.
#include "hal/avr/encoders.h"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <util/atomic.h>

#include "hal/avr/quadrature.h"
#include "pins.h"

namespace screed {
namespace avr {
namespace {

// Written by the interrupt; read with interrupts off (a barrier for the compiler as well).
struct State {
  Quadrature left;
  Quadrature right;
};
State state;

}  // namespace

#ifdef SCREED_RIGHT_ENCODER_ON_INT6
// Each side is read by its own interrupt only: the two pins of a side are read one after the other,
// and right after an edge of this side there is no next one in between.
ISR(PCINT0_vect) {
  state.left.update(read_left_encoder());
}
ISR(INT6_vect) {
  state.right.update(read_right_encoder());
}
#else
ISR(PCINT0_vect) {
  state.left.update(read_left_encoder());
  state.right.update(read_right_encoder());
}
#endif

void encoders_init() {
  make_encoder_pins_inputs();
  state.left.start(read_left_encoder());
  state.right.start(read_right_encoder());
  enable_encoder_interrupts();
}

EncoderCounts encoders_read() {
  EncoderCounts counts;
  ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
    counts.left = state.left.count;
    counts.right = state.right.count;
    counts.errors = static_cast<uint8_t>(state.left.errors + state.right.errors);
  }
  return counts;
}

}  // namespace avr
}  // namespace screed
