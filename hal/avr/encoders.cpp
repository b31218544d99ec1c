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

ISR(PCINT0_vect) {
  const EncoderLevels levels = read_encoder_pins();
  state.left.update(levels.left);
  state.right.update(levels.right);
}

#ifdef SCREED_ENCODER_USES_INT6
ISR(INT6_vect, ISR_ALIASOF(PCINT0_vect));
#endif

void encoders_init() {
  make_encoder_pins_inputs();
  const EncoderLevels levels = read_encoder_pins();
  state.left.start(levels.left);
  state.right.start(levels.right);
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
