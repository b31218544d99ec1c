#include "nn/infer/gated.h"

#include "hal/program_memory.h"

namespace screed {
namespace nn {
namespace {

constexpr int16_t kOne_q12 = 4096;

/// A row's sum limited to +-1. Out of line: the image has it once.
__attribute__((noinline)) int16_t limited_row(const int8_t* row, const int8_t* x, uint8_t count) {
  const int16_t sum = screed_nn_row8(row, x, count);
  return sum < -kOne_q12 ? static_cast<int16_t>(-kOne_q12)
                         : (sum < kOne_q12 ? sum : static_cast<int16_t>(kOne_q12 - 1));
}

}  // namespace

#ifndef __AVR__
extern "C" int16_t screed_nn_row8(const int8_t* row, const int8_t* x, uint8_t count) {
  int32_t sum = static_cast<int32_t>(row[0]) * 128;
  for (uint8_t i = 0; i < count; ++i) sum += static_cast<int32_t>(row[1 + i]) * x[i];
  return static_cast<int16_t>(sum < INT16_MIN ? INT16_MIN : (sum > INT16_MAX ? INT16_MAX : sum));
}
#endif

void gated_candidates(const GatedShape& shape, const int8_t* parameters, const int8_t* x,
                      int16_t* candidates) {
  for (uint8_t i = 0; i < shape.units; ++i) {
    candidates[i] = static_cast<int16_t>(limited_row(parameters, x, shape.values()) * 8);
    parameters += shape.row_size();
  }
}

void gated_update(const GatedShape& shape, const int8_t* parameters, int8_t* x,
                  const int16_t* candidates, int16_t* states, int16_t* outputs) {
  parameters += shape.gates_begin();
  for (uint8_t i = 0; i < shape.units; ++i) {
    // + 2^12 once within bounds, so that it does not overflow.
    const auto open = static_cast<uint8_t>(
        static_cast<uint16_t>(limited_row(parameters, x, shape.values()) + kOne_q12) >> 5);
    const auto gate = static_cast<uint8_t>(static_cast<uint16_t>(open) * open >> 8);
    const auto half = static_cast<int16_t>((candidates[i] >> 1) - (states[i] >> 1));
    states[i] = static_cast<int16_t>(states[i] + ((static_cast<int32_t>(half) * gate) >> 7));
    parameters += shape.row_size();
  }
  int8_t* const state_bytes = x + shape.inputs;
  for (uint8_t i = 0; i < shape.units; ++i) state_bytes[i] = static_cast<int8_t>(states[i] >> 8);
  for (uint8_t i = 0; i < shape.outputs; ++i) {
    outputs[i] = screed_nn_row8(parameters, state_bytes, shape.units);
    parameters += 1 + shape.units;
  }
}

}  // namespace nn
}  // namespace screed
