// Both track encoders, counted by pin interrupts.
#include "hal/avr/encoders.h"

#include <avr/interrupt.h>
#include <avr/io.h>

#include "hal/avr/interrupts_off.h"
#include "hal/avr/quadrature.h"
#include "pins.h"

namespace screed {
namespace avr {
namespace {

// Written by the interrupt; read with interrupts off (a barrier for the compiler as well).
struct State {
  Quadrature left;
  Quadrature right;
  uint8_t edges;  // since the last read, both sides
};
State state;

/// More edges in a tick than a board's limit are none of a track: a wire that picks up a radio or a
/// motor can bring one every few microseconds, and with them the main loop would stand still. The
/// encoders are deaf then until they are read.
inline void count_edge() {
  if (++state.edges == kMaxEncoderEdges) disable_encoder_interrupts();
}

/// Goes on from the levels of this moment.
__attribute__((noinline)) void listen() {
  state.left.start(read_left_encoder());
  state.right.start(read_right_encoder());
  enable_encoder_interrupts();
}

}  // namespace

#ifdef SCREED_RIGHT_ENCODER_ON_INT6
// Each side is read by its own interrupt only: the two pins of a side are read one after the other,
// and right after an edge of this side there is no next one in between.
ISR(PCINT0_vect) {
  state.left.update(read_left_encoder());
  count_edge();
}
ISR(INT6_vect) {
  state.right.update(read_right_encoder());
  count_edge();
}
#else
ISR(PCINT0_vect) {
  state.left.update(read_left_encoder());
  state.right.update(read_right_encoder());
  count_edge();
}
#endif

void encoders_init() {
  make_encoder_pins_inputs();
  listen();
}

EncoderCounts encoders_read() {
  EncoderCounts counts;
  {
    const InterruptsOff interrupts_off;
    counts.left = state.left.count;
    counts.right = state.right.count;
    if (state.edges >= kMaxEncoderEdges) {
      ++state.left.errors;
      listen();
    }
    state.edges = 0;
    counts.errors = static_cast<uint8_t>(state.left.errors + state.right.errors);
  }
  return counts;
}

}  // namespace avr
}  // namespace screed
