// Random and edge vectors through the network's layers. The same code runs on the MCU and on the
// host, with any bytes as parameters: the arithmetic is exact modulo 2^32 even where no real
// network goes, so every shift, carry and end of a range is met.
#pragma once

#include <stdint.h>

#include "hal/program_memory.h"
#include "nn/infer/dense.h"
#include "nn/infer/gated.h"

namespace screed {

/// 200 blocks of 100 vectors.
constexpr uint16_t kNetworkBlocks = 200;
constexpr uint16_t kVectorsPerBlock = 100;
/// Recurrent layers: each block has its own parameters and runs this many steps.
constexpr uint16_t kGatedBlocks = 100;
constexpr uint16_t kGatedSteps = 20;

/// Bytes that serve as parameters from any offset: an xorshift sequence, and runs of the edges.
constexpr uint16_t kParameterBytes = 2048;
extern const uint8_t kParameters[kParameterBytes] SCREED_PROGRAM_MEMORY;

class VectorNumbers {
 public:
  explicit VectorNumbers(uint32_t seed) : state_(seed) {}
  uint32_t any() {
    state_ ^= state_ << 13;
    state_ ^= state_ >> 17;
    state_ ^= state_ << 5;
    return state_;
  }
  /// An activation: any, or one of the edges.
  int16_t activation() {
    const uint32_t bits = any();
    switch (bits >> 28) {
      case 0:
        return INT16_MIN;
      case 1:
        return INT16_MAX;
      case 2:
        return 0;
      case 3:
        return -1;
      default:
        return static_cast<int16_t>(static_cast<uint16_t>(bits));
    }
  }

 private:
  uint32_t state_;
};

/// FNV-1a.
inline uint32_t hashed(uint32_t hash, uint8_t byte) {
  return (hash ^ byte) * 16777619UL;
}

/// Results of `vectors` vectors through layers of all kinds of kernels, hashed.
inline uint32_t network_vectors_hash(uint32_t seed, uint16_t vectors) {
  VectorNumbers numbers(seed);
  uint32_t hash = 2166136261UL;
  int16_t in[20];
  int16_t out[20];
  for (uint16_t n = 0; n < vectors; ++n) {
    for (uint8_t i = 0; i < 20; ++i) in[i] = numbers.activation();
    const uint8_t* parameters =
        kParameters +
        static_cast<uint16_t>(numbers.any() % (kParameterBytes - 20 * nn::row_size(4)));
    uint8_t outputs = 0;
    switch (static_cast<uint8_t>(n & 7)) {
      case 0:
        nn::dense<4, 20, 0>(parameters, in, out);
        outputs = 20;
        break;
      case 1:
        nn::dense<4, 3, 14>(parameters, in, out);
        outputs = 3;
        break;
      case 2:
        nn::dense<7, 7, 0>(parameters, in, out);
        outputs = 7;
        break;
      case 3:
        nn::dense<7, 7, 2>(parameters, in, out);
        outputs = 7;
        break;
      case 4:
        nn::dense<7, 2, 4 | nn::kLinear>(parameters, in, out);
        outputs = 2;
        break;
      case 5:
        nn::dense<20, 1, 3>(parameters, in, out);
        outputs = 1;
        break;
      case 6:
        nn::dense<20, 2, 0 | nn::kLinear>(parameters, in, out);
        outputs = 2;
        break;
      default:
        nn::dense<1, 5, 1>(parameters, in, out);
        outputs = 5;
        break;
    }
    for (uint8_t i = 0; i < outputs; ++i) {
      const uint16_t bits = static_cast<uint16_t>(out[i]);
      hash = hashed(hash, static_cast<uint8_t>(bits));
      hash = hashed(hash, static_cast<uint8_t>(bits >> 8));
    }
  }
  return hash;
}

/// Outputs and states of a recurrent layer over random inputs, hashed.
inline uint32_t gated_hash(uint32_t seed) {
  constexpr nn::GatedShape kShape = {5, 4, 2};
  VectorNumbers numbers(seed);
  const auto* parameters = reinterpret_cast<const int8_t*>(
      kParameters + static_cast<uint16_t>(numbers.any() % (kParameterBytes - kShape.size())));
  int8_t x[kShape.values()] = {};
  int16_t candidates[kShape.units];
  int16_t states[kShape.units] = {};
  int16_t outputs[kShape.outputs];
  uint32_t hash = 2166136261UL;
  for (uint16_t step = 0; step < kGatedSteps; ++step) {
    for (uint8_t i = 0; i < kShape.inputs; ++i)
      x[i] = static_cast<int8_t>(static_cast<uint16_t>(numbers.activation()) >> 8);
    nn::gated_candidates(kShape, parameters, x, candidates);
    nn::gated_update(kShape, parameters, x, candidates, states, outputs);
    const int16_t results[] = {outputs[0], outputs[1], states[0], states[3]};
    for (const int16_t result : results) {
      hash = hashed(hash, static_cast<uint8_t>(static_cast<uint16_t>(result)));
      hash = hashed(hash, static_cast<uint8_t>(static_cast<uint16_t>(result) >> 8));
    }
  }
  return hash;
}

/// tanh at 256 arguments from `first`, hashed.
inline uint32_t tanh_hash(uint16_t first) {
  uint32_t hash = 2166136261UL;
  for (uint16_t i = 0; i < 256; ++i) {
    const uint16_t bits =
        static_cast<uint16_t>(nn::tanh_q15(static_cast<int16_t>(static_cast<uint16_t>(first + i))));
    hash = hashed(hash, static_cast<uint8_t>(bits));
    hash = hashed(hash, static_cast<uint8_t>(bits >> 8));
  }
  return hash;
}

/// The shapes of the thesis' networks: 4-20-1, and 13 hidden layers of 7. in: 4 numbers.
inline int16_t small_network(const uint8_t* parameters, const int16_t* in) {
  int16_t hidden[20];
  int16_t out;  // NOLINT(cppcoreguidelines-init-variables): dense() sets it; its time is measured
  nn::dense<4, 20, 0>(parameters, in, hidden);
  nn::dense<20, 1, 0>(parameters + 20 * nn::row_size(4), hidden, &out);
  return out;
}
inline int16_t deep_network(const uint8_t* parameters, const int16_t* in) {
  int16_t a[7];
  int16_t b[7];
  nn::dense<4, 7, 0>(parameters, in, a);
  for (uint8_t pair = 0; pair < 6; ++pair) {
    nn::dense<7, 7, 0>(parameters, a, b);
    nn::dense<7, 7, 0>(parameters + 7 * nn::row_size(7), b, a);
  }
  int16_t out;  // NOLINT(cppcoreguidelines-init-variables): dense() sets it; its time is measured
  nn::dense<7, 1, 0>(parameters, a, &out);
  return out;
}

}  // namespace screed
