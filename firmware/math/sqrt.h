// Integer square root. Knows nothing of its users.
#pragma once

#include <stdint.h>

#include "firmware/math/fixed.h"

namespace screed {

/// floor(sqrt(value)), exact for every value. Digit by digit, two bits of the radicand a step: no
/// division.
SCREED_OUT_OF_LINE inline uint16_t isqrt32(uint32_t value) {
#ifdef __AVR__
  // gcc-avr computes with 32 bits throughout: 122 bytes in place of 76. Here two bits of the
  // radicand move into the remainder; where that is at least t = 4 root + 1, the next digit of the
  // root is 1. Kept is 2 root: t - 1 without that digit, t + 1 with it. 24 bits hold both.
  uint16_t remainder = 0;
  uint16_t twice = 0;
  uint8_t remainder_top = 0;
  uint8_t twice_top = 0;
  uint8_t steps = 16;
  uint8_t bits;
  asm("1:\n\t"
      "ldi %[bits], 2\n"
      "2:\n\t"
      "lsl %A[value]\n\t"
      "rol %B[value]\n\t"
      "rol %C[value]\n\t"
      "rol %D[value]\n\t"
      "rol %A[remainder]\n\t"
      "rol %B[remainder]\n\t"
      "rol %[remainder_top]\n\t"
      "dec %[bits]\n\t"
      "brne 2b\n\t"
      "lsl %A[twice]\n\t"
      "rol %B[twice]\n\t"
      "rol %[twice_top]\n\t"
      "inc %A[twice]\n\t"  // t
      "cp %A[remainder], %A[twice]\n\t"
      "cpc %B[remainder], %B[twice]\n\t"
      "cpc %[remainder_top], %[twice_top]\n\t"
      "brcs 3f\n\t"
      "sub %A[remainder], %A[twice]\n\t"
      "sbc %B[remainder], %B[twice]\n\t"
      "sbc %[remainder_top], %[twice_top]\n\t"
      "subi %A[twice], -2\n"  // t ends with the bits 01
      "3:\n\t"
      "dec %A[twice]\n\t"
      "dec %[steps]\n\t"
      "brne 1b\n\t"
      "lsr %[twice_top]\n\t"
      "ror %B[twice]\n\t"
      "ror %A[twice]\n\t"
      : [value] "+r"(value), [remainder] "+r"(remainder), [remainder_top] "+r"(remainder_top),
        [twice] "+d"(twice), [twice_top] "+r"(twice_top), [steps] "+r"(steps), [bits] "=&d"(bits));
  return twice;
#else
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
#endif
}

}  // namespace screed
