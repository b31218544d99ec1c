// A fully connected layer in integers: the arithmetic of every network of the project, the same
// bits on the robot, on the host and in the batched engine. Knows no network, no units and no file.
//
// Numbers. An activation is an int16_t q that stands for (q + 1/2) / 2^15, so -1 < value < 1 and
// ~q stands for exactly the opposite value: a floor shift is then unbiased, and tanh can be odd to
// the last bit. A weight w is an int16_t that stands for w / 2^(14 - gain_shift).
//
// A node:
//   sum = bias + w_1 q_1 + ... + w_n q_n        int32_t; the quantiser proves that it cannot
//   overflow z   = sum / 2^(16 - gain_shift)             floor, limited to int16_t; (z + 1/2) /
//   2^13 in [-4, 4) y   = tanh_q15(z), or z itself for a linear node (then 2^(14 - gain_shift) is a
//   scale of choice)
//
// How parameters lie in memory (program memory on the AVR), a row a node:
//   u32        bias + 2^30 n - 2^15 (W_1 + ... + W_n), modulo 2^32
//   n times u16  W = w + 2^15
// The offsets make all factors unsigned, which saves the AVR a quarter of a multiply-accumulate:
//   sum = row's constant + sum of W_i (q_i + 2^15) - 2^15 sum of (q_i + 2^15), modulo 2^32.
#pragma once

#include <stdint.h>

namespace screed {
namespace nn {

constexpr uint8_t kMaxGainShift = 14;
constexpr uint8_t kMaxInputs = 255;
constexpr uint8_t kLinear = 0x40;  ///< in DenseShape::mode

/// Bytes of a row with this many inputs.
constexpr uint16_t row_size(uint8_t inputs) {
  return static_cast<uint16_t>(4 + 2 * inputs);
}

struct DenseShape {
  uint8_t inputs;   ///< 1..255
  uint8_t outputs;  ///< 1..255
  uint8_t mode;     ///< gain_shift 0..kMaxGainShift, | kLinear for a layer without tanh
};

/// Odd piecewise linear tanh: argument (z + 1/2) / 2^13, result (y + 1/2) / 2^15. Within 7.5e-5 of
/// tanh for |argument| < 4, constant beyond (0.0007 short of 1).
int16_t tanh_q15(int16_t z);

/// Computes a layer. parameters: outputs rows as above, in program memory; in: inputs numbers;
/// out: outputs numbers, must not overlap in.
void dense(const DenseShape& shape, const uint8_t* parameters, const int16_t* in, int16_t* out);

#ifdef __AVR__
// The AVR's kernels (dense_avr.cpp): the first keeps all inputs in registers, for 1 to 7 inputs, by
// the number of inputs; the other streams them. Cycles a node: 26 n + 72, and 34 n + 80.
extern "C" {
void screed_nn_dense4(const int16_t* in, int16_t* out, const uint8_t* parameters, uint8_t outputs,
                      uint8_t mode);
void screed_nn_dense7(const int16_t* in, int16_t* out, const uint8_t* parameters, uint8_t outputs,
                      uint8_t mode);
void screed_nn_dense(const int16_t* in, int16_t* out, const uint8_t* parameters, uint8_t outputs,
                     uint8_t mode, uint8_t inputs);
/// The same for linear layers alone: brings no table of tanh into the image.
void screed_nn_dense_linear(const int16_t* in, int16_t* out, const uint8_t* parameters,
                            uint8_t outputs, uint8_t mode, uint8_t inputs);
}
#endif

/// The same with a shape that is known to the compiler: only the kernel that is wanted reaches the
/// image.
template <uint8_t kInputs, uint8_t kOutputs, uint8_t kMode>
inline void dense(const uint8_t* parameters, const int16_t* in, int16_t* out) {
#ifdef __AVR__
  if ((kMode & kLinear) != 0) {
    screed_nn_dense_linear(in, out, parameters, kOutputs, kMode, kInputs);
  } else if (kInputs == 4) {
    screed_nn_dense4(in, out, parameters, kOutputs, kMode);
  } else if (kInputs == 7) {
    screed_nn_dense7(in, out, parameters, kOutputs, kMode);
  } else {
    screed_nn_dense(in, out, parameters, kOutputs, kMode, kInputs);
  }
#else
  dense(DenseShape{kInputs, kOutputs, kMode}, parameters, in, out);
#endif
}

}  // namespace nn
}  // namespace screed
