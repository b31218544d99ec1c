#include "nn/infer/dense.h"

#include "nn/infer/tanh_table.h"

namespace screed {
namespace nn {

// What the quantiser and the AVR's kernels rely on as well: >> copies the sign, and conversion to a
// signed type wraps.
static_assert((-1 >> 1) == -1, "arithmetic right shift of negative integers is required");
static_assert(static_cast<int16_t>(static_cast<uint16_t>(0xFFFF)) == -1, "wrapping is required");

namespace {

constexpr uint16_t kOffset = 0x8000;

uint16_t without_sign(int16_t q) {
  return static_cast<uint16_t>(static_cast<uint16_t>(q) ^ kOffset);
}

int16_t limited(int32_t value) {
  return static_cast<int16_t>(value < INT16_MIN ? INT16_MIN
                                                : (value > INT16_MAX ? INT16_MAX : value));
}

}  // namespace

int16_t tanh_q15(int16_t z) {
  const uint16_t magnitude = static_cast<uint16_t>(z < 0 ? ~z : z);
  const int16_t* segment = screed_nn_tanh_table + (magnitude >> 8);
  const uint16_t begin = static_cast<uint16_t>(read_program_i16(segment));
  const uint16_t rise = static_cast<uint16_t>(read_program_i16(segment + 1) - begin);
  const uint32_t part = static_cast<uint32_t>(rise) * (magnitude & 0xFFU) >> 8;
  const int16_t y = static_cast<int16_t>(begin + part);
  return static_cast<int16_t>(z < 0 ? ~y : y);
}

void dense(const DenseShape& shape, const uint8_t* parameters, const int16_t* in, int16_t* out) {
  uint32_t sum_of_inputs = 0;
  for (uint8_t i = 0; i < shape.inputs; ++i) sum_of_inputs += without_sign(in[i]);
  const uint8_t shift = static_cast<uint8_t>(16 - (shape.mode & ~kLinear));
  for (uint8_t node = 0; node < shape.outputs; ++node) {
    uint32_t sum = read_program_u32(parameters) - (sum_of_inputs << 15);
    parameters += 4;
    for (uint8_t i = 0; i < shape.inputs; ++i) {
      sum += static_cast<uint32_t>(read_program_u16(parameters)) * without_sign(in[i]);
      parameters += 2;
    }
    const int16_t z = limited(static_cast<int32_t>(sum) >> shift);
    out[node] = (shape.mode & kLinear) != 0 ? z : tanh_q15(z);
  }
}

}  // namespace nn
}  // namespace screed
