// Random numbers of one agent: SFC32 (C. Doty-Humphrey, PractRand 2010). Additions, shifts and a
// rotation of 32 bits: cheap on a microcontroller as well. 32 bits a draw, period at least 2^32.
#pragma once

#include <stdint.h>

#include "host_sim/grid/agents/grid_types.h"

namespace screed {

class GridRandom {
 public:
  /// Every pair of seed and stream gives a sequence of its own.
  GridRandom(uint32_t seed, uint32_t stream) : a_(seed), b_(stream), c_(0x9E3779B9U) {
    for (uint8_t i = 0; i < 15; ++i) next();
  }

  uint32_t next() {
    const uint32_t result = a_ + b_ + counter_++;
    a_ = b_ ^ (b_ >> 9);
    b_ = c_ + (c_ << 3);
    c_ = ((c_ << 21) | (c_ >> 11)) + result;
    return result;
  }

  /// Uniform in 0..count-1; off by at most count / 2^32 of a probability. count in 1..65535.
  uint16_t below(uint16_t count) {
    // The upper half of the product of 32 and 16 bits, built of halves.
    const uint32_t draw = next();
    const uint32_t low = (draw & 0xFFFFU) * count;
    return static_cast<uint16_t>(((draw >> 16) * count + (low >> 16)) >> 16);
  }

 private:
  uint32_t a_;
  uint32_t b_;
  uint32_t c_;
  uint32_t counter_ = 1;
};

/// Whether an event of that probability happens, by 16 random bits.
inline bool bernoulli(uint32_t bits16, Probability probability) {
  return bits16 < probability;
}

}  // namespace screed
