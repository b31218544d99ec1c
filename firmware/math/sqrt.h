// Integer square root. Knows nothing of its users.
#pragma once

#include <stdint.h>

#include "firmware/math/fixed.h"

namespace screed {

/// floor(sqrt(value)), exact for every value. Digit by digit, two bits of the radicand a step: no
/// division.
SCREED_CONSTEXPR14 uint16_t isqrt32(uint32_t value) {
  uint32_t remainder = value;
  uint32_t root = 0;
  for (uint32_t bit = static_cast<uint32_t>(1) << 30; bit != 0; bit >>= 2) {
    const uint32_t trial = root + bit;
    root >>= 1;
    if (remainder >= trial) {
      remainder -= trial;
      root += bit;
    }
  }
  return static_cast<uint16_t>(root);
}

}  // namespace screed
