// A recurrent layer of minimal gated units (Zhou et al., 2016; here with the gate squared, so that
// small ones are fine) and linear outputs, in integers with weights of 8 bits: the same bits on the
// robot and on the host. Knows no units and no file.
//
// Values x are int8_t and stand for x / 128; weights and biases are int8_t and stand for w / 32.
// The vector x has the inputs first, then the state of the units. A row is its bias and a weight
// for each of x, in program memory; first the candidates' rows, then the gates', then the outputs'
// (which see the units alone).
//   sum = 128 bias + w_1 x_1 + ... + w_n x_n, limited to int16_t     value sum / 2^12
// A unit, with its state s (int16_t, value s / 2^15, x = s >> 8):
//   c = sum of its candidate's row, limited to +-1, in Q15
//   u = (sum of its gate's row + 2^12) limited to 0..2^13 - 1, >> 5  value (sum + 1) / 2 in Q8
//   s += (((c >> 1) - (s >> 1)) * (u * u >> 8)) >> 7
#pragma once

#include <stdint.h>

namespace screed {
namespace nn {

struct GatedShape {
  uint8_t inputs;
  uint8_t units;
  uint8_t outputs;

  constexpr uint8_t values() const { return static_cast<uint8_t>(inputs + units); }
  constexpr uint16_t row_size() const { return static_cast<uint16_t>(1 + values()); }
  constexpr uint16_t gates_begin() const { return static_cast<uint16_t>(units * row_size()); }
  constexpr uint16_t outputs_begin() const { return static_cast<uint16_t>(2 * gates_begin()); }
  constexpr uint16_t size() const {
    return static_cast<uint16_t>(outputs_begin() + outputs * (1 + units));
  }
};

extern "C" {
/// The sum of a row in program memory over `count` (1..255) values.
int16_t screed_nn_row8(const int8_t* row, const int8_t* x, uint8_t count);
}

/// First half of a step, for which x holds inputs and states: the candidates, Q15, of all units.
void gated_candidates(const GatedShape& shape, const int8_t* parameters, const int8_t* x,
                      int16_t* candidates);

/// Second half: moves the states, then writes them to x as well, and the sums of the outputs.
void gated_update(const GatedShape& shape, const int8_t* parameters, int8_t* x,
                  const int16_t* candidates, int16_t* states, int16_t* outputs);

}  // namespace nn
}  // namespace screed
