// A small random generator for the robot's own decisions: 32-bit xorshift (Marsaglia 2003, triple
// 13, 17, 5). The same seed gives the same robot on every target.
#pragma once

#include <stdint.h>

#include "firmware/math/fixed.h"

namespace screed {

class Random {
 public:
  explicit Random(uint16_t seed = 1) { reset(seed); }

  /// Any seed is allowed; nearby seeds give unrelated sequences.
  void reset(uint16_t seed) {
    state_ = (static_cast<uint32_t>(seed) + 1U) *
             2654435769U;  // never 0: the factor is odd, seed + 1 < 2^32
    for (uint8_t i = 0; i < 8; ++i) next();
  }

  /// Uniform in [low, high], both included; low <= high.
  int16_t uniform(int16_t low, int16_t high) {
    const auto span =
        static_cast<uint16_t>(static_cast<uint16_t>(high) - static_cast<uint16_t>(low));
    const auto random = static_cast<uint16_t>(next() >> 16);
    // 16 random bits times span + 1, which is up to 2^16.
    const auto pick = static_cast<uint16_t>((mul_u16(random, span) + random) >> 16);
    return static_cast<int16_t>(static_cast<uint16_t>(static_cast<uint16_t>(low) + pick));
  }

 private:
  SCREED_OUT_OF_LINE uint32_t next() {
    state_ ^= state_ << 13;
    state_ ^= state_ >> 17;
    state_ ^= state_ << 5;
    return state_;
  }

  uint32_t state_ = 1;
};

}  // namespace screed
