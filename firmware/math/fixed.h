// Fixed-point arithmetic shared by firmware and host: shifts, saturation, products. Knows nothing
// of sensors or robots.
//
// Q formats of the project. "Qn" is an integer that stands for value / 2^n.
//   Angle  int16_t  1/65536 turn   plane angles; wrap, never saturate (trig.h)
//   Q14    int16_t  2^-14, [-2,2)  elements of rotation matrices
//   Q15    int16_t  2^-15, [-1,1)  sines and cosines; the value 1 is 32767
//   Q16    int16_t  2^-16          factors within +-1/2 for scale_q16: gains of filters
//   Q30    int32_t  2^-30, [-2,2)  components of quaternions
//   mm, mm/s       int16_t or int32_t, 1 mm, 1 mm/s
//   IMU counts     int16_t, 70 mdps, 0.244 mg, 0.160 mG
// Formats that one file alone needs are documented in that file.
//
// The AVR has an 8x8 multiplier and a 16-bit int: products here are built from 16x16 -> 32 bit
// parts (45 cycles each there), never from 64-bit integers, and every operand is widened by hand.
#pragma once

#include <stdint.h>

/// Keeps a function that is called dozens of times out of line where flash is scarce; of no effect
/// on the host.
#ifdef __AVR__
#define SCREED_OUT_OF_LINE __attribute__((noinline))
#define SCREED_IN_LINE __attribute__((always_inline))
#else
#define SCREED_OUT_OF_LINE
#define SCREED_IN_LINE
#endif

/// A function of several statements that constant expressions may call. The Arduino IDE compiles as
/// C++11, which knows no such functions: there it is an ordinary one.
#if __cplusplus >= 201402L
#define SCREED_CONSTEXPR14 constexpr
#else
#define SCREED_CONSTEXPR14 inline
#endif

namespace screed {

// Right shift of a negative number is left to the compiler before C++20; every compiler of this
// project shifts in copies of the sign. All such shifts of the firmware go through asr(), so this
// is the one place that relies on it.
static_assert((-1 >> 1) == -1, "arithmetic right shift of negative integers is required");

// The same holds for the conversion of an unsigned number that does not fit: it must wrap (modulo
// 2^n).
static_assert(static_cast<int16_t>(static_cast<uint16_t>(0xFFFF)) == -1, "wrapping is required");

constexpr int16_t kQ15One = 32767;                          ///< the largest Q15, 1 - 2^-15
constexpr int32_t kQ30One = static_cast<int32_t>(1) << 30;  ///< 1.0 in Q30

namespace detail {

/// One loop for the shifts of 32 bits, behind a move of bytes: gcc-avr would write one out for
/// each.
SCREED_OUT_OF_LINE constexpr int32_t shift_by_loop(int32_t value, uint8_t n) {
  return n < 8 ? value >> n : (value >> 8) >> (n - 8);
}

}  // namespace detail

/// floor(value / 2^n), n in 0..31.
SCREED_IN_LINE constexpr int32_t asr(int32_t value, uint8_t n) {
  // Whole bytes are moves.
  return __builtin_constant_p(n) && n == 16 ? value >> n : detail::shift_by_loop(value, n);
}

/// floor(value / 2^n) of a short number, n in 0..15.
constexpr int16_t asr_i16(int16_t value, uint8_t n) {
  return static_cast<int16_t>(value >> n);
}

/// |value| as unsigned, right for INT16_MIN as well, without 32 bits.
SCREED_OUT_OF_LINE constexpr uint16_t abs_i16(int16_t value) {
  return value < 0 ? static_cast<uint16_t>(0U - static_cast<uint16_t>(value))
                   : static_cast<uint16_t>(value);
}

/// value / 2^n rounded to nearest, halves up. n in 1..31; |value| + 2^(n-1) must fit 32 bits.
SCREED_OUT_OF_LINE constexpr int32_t asr_round(int32_t value, uint8_t n) {
  // Not value + 2^(n-1): a shift by a variable number of bits is a second loop on the AVR.
  return asr(asr(value, static_cast<uint8_t>(n - 1)) + 1, 1);
}

/// value limited to [-limit, limit]; limit >= 0.
SCREED_OUT_OF_LINE constexpr int32_t limit_i32(int32_t value, int32_t limit) {
  return value > limit ? limit : value < -limit ? -limit : value;
}

/// value limited to [-limit, limit]; limit >= 0. A call of it is shorter than one of limit_i32().
SCREED_OUT_OF_LINE constexpr int16_t limit_i16(int32_t value, int16_t limit) {
  return static_cast<int16_t>(limit_i32(value, limit));
}

/// value limited to [low, high]; low <= high.
SCREED_OUT_OF_LINE constexpr int16_t clamp_i16(int16_t value, int16_t low, int16_t high) {
  return value < low ? low : (value > high ? high : value);
}

/// value limited to the range of int16_t.
SCREED_OUT_OF_LINE constexpr int16_t saturate_i16(int32_t value) {
  return static_cast<int16_t>(value > INT16_MAX   ? INT16_MAX
                              : value < INT16_MIN ? INT16_MIN
                                                  : value);
}

/// |value| as unsigned, right for INT32_MIN as well.
SCREED_OUT_OF_LINE constexpr uint32_t abs_u32(int32_t value) {
  return value < 0 ? static_cast<uint32_t>(0) - static_cast<uint32_t>(value)
                   : static_cast<uint32_t>(value);
}

/// Sum that stops at the ends of int32_t instead of overflowing.
SCREED_OUT_OF_LINE constexpr int32_t add_sat_i32(int32_t a, int32_t b) {
  return b > 0 ? (a > INT32_MAX - b ? INT32_MAX : a + b) : (a < INT32_MIN - b ? INT32_MIN : a + b);
}

// Out of line, since gcc-avr's multiplications take their factors in registers that are hard to
// keep free where one is called.

/// The exact 32-bit product of two 16-bit numbers.
SCREED_OUT_OF_LINE constexpr int32_t mul_i16(int16_t a, int16_t b) {
  return static_cast<int32_t>(a) * static_cast<int32_t>(b);
}

/// The exact 32-bit product of two unsigned 16-bit numbers.
SCREED_OUT_OF_LINE constexpr uint32_t mul_u16(uint16_t a, uint16_t b) {
  return static_cast<uint32_t>(a) * b;
}

namespace detail {

/// Exact signed x unsigned product.
SCREED_OUT_OF_LINE constexpr int32_t mul_su(int16_t a, uint16_t b) {
  return static_cast<int32_t>(a) * static_cast<int32_t>(b);
}

/// floor(value / 2^16); a plain move on the AVR.
SCREED_IN_LINE constexpr int16_t high_half(int32_t value) {
  return static_cast<int16_t>(static_cast<uint16_t>(static_cast<uint32_t>(value) >> 16));
}

/// The lower 16 bits of a 32-bit number.
constexpr uint16_t low_half(int32_t value) {
  return static_cast<uint16_t>(static_cast<uint32_t>(value) & 0xFFFFU);
}

}  // namespace detail

/// floor((a * k + 2^15) / 2^16): a wide number times a Q16 factor within +-1/2 (or half of a Q15
/// factor), the exact product rounded to nearest, halves up. All of int32 x int16 is allowed.
SCREED_OUT_OF_LINE inline int32_t scale_q16(int32_t a, int16_t k) {
#ifdef __AVR__
  // The attitude estimator spends most of its time here, and gcc-avr makes 150 cycles of what takes
  // 70: it calls its 16 x 16 multiplication twice and saves a dozen registers for that. Unsigned
  // partial products of bytes, added at their places from 2^8 up; then the two sign corrections,
  // each modulo 2^48.
  int32_t result = 0;
  uint8_t fraction = 0;
  uint8_t zero = 0;
  asm("clr %[zero]\n\t"
      "mul %A[a], %A[k]\n\t"  // 2^0: only the upper byte matters
      "mov %[fraction], r1\n\t"
      "mul %C[a], %A[k]\n\t"  // 2^16
      "movw %A[result], r0\n\t"
      "mul %D[a], %B[k]\n\t"  // 2^32
      "movw %C[result], r0\n\t"
      "mul %B[a], %B[k]\n\t"  // 2^16
      "add %A[result], r0\n\t"
      "adc %B[result], r1\n\t"
      "adc %C[result], %[zero]\n\t"
      "adc %D[result], %[zero]\n\t"
      "mul %A[a], %B[k]\n\t"  // 2^8
      "add %[fraction], r0\n\t"
      "adc %A[result], r1\n\t"
      "adc %B[result], %[zero]\n\t"
      "adc %C[result], %[zero]\n\t"
      "adc %D[result], %[zero]\n\t"
      "mul %B[a], %A[k]\n\t"  // 2^8
      "add %[fraction], r0\n\t"
      "adc %A[result], r1\n\t"
      "adc %B[result], %[zero]\n\t"
      "adc %C[result], %[zero]\n\t"
      "adc %D[result], %[zero]\n\t"
      "mul %D[a], %A[k]\n\t"  // 2^24
      "add %B[result], r0\n\t"
      "adc %C[result], r1\n\t"
      "adc %D[result], %[zero]\n\t"
      "mul %C[a], %B[k]\n\t"  // 2^24
      "add %B[result], r0\n\t"
      "adc %C[result], r1\n\t"
      "adc %D[result], %[zero]\n\t"
      "lsl %[fraction]\n\t"  // round
      "adc %A[result], %[zero]\n\t"
      "adc %B[result], %[zero]\n\t"
      "adc %C[result], %[zero]\n\t"
      "adc %D[result], %[zero]\n\t"
      "sbrs %D[a], 7\n\t"  // a < 0: k 2^32 too much
      "rjmp 1f\n\t"
      "sub %C[result], %A[k]\n\t"
      "sbc %D[result], %B[k]\n"
      "1:\n\t"
      "sbrs %B[k], 7\n\t"  // k < 0: a 2^16 too much
      "rjmp 2f\n\t"
      "sub %A[result], %A[a]\n\t"
      "sbc %B[result], %B[a]\n\t"
      "sbc %C[result], %C[a]\n\t"
      "sbc %D[result], %D[a]\n"
      "2:\n\t"
      "clr r1\n\t"
      : [result] "=&r"(result), [fraction] "=&r"(fraction), [zero] "=&r"(zero)
      : [a] "r"(a), [k] "r"(k)
      : "r0");
  return result;
#else
  const int32_t low =
      detail::mul_su(k, detail::low_half(a)) + 0x8000;  // fits: at most 2^31 - 2^16 + 2^15
  return mul_i16(detail::high_half(a), k) + detail::high_half(low);
#endif
}

#ifdef __AVR__
namespace detail {

/// floor(a / b) in the lower `bits`; 16 where the upper half of a is less than b, else 32.
SCREED_OUT_OF_LINE inline uint32_t divide(uint32_t a, uint16_t b, uint8_t bits) {
  // gcc-avr's 32-bit division takes 650 cycles, this one 250 for 16 bits: the remainder has 16 bits
  // (and a carry). As the digits of a move out above those of the quotient move in.
  uint16_t remainder = 0;
  if (bits == 16) {
    remainder = static_cast<uint16_t>(a >> 16);
    a <<= 16;
  }
  asm("1:\n\t"
      "lsl %A[a]\n\t"
      "rol %B[a]\n\t"
      "rol %C[a]\n\t"
      "rol %D[a]\n\t"
      "rol %A[remainder]\n\t"
      "rol %B[remainder]\n\t"
      "brcs 2f\n\t"
      "cp %A[remainder], %A[b]\n\t"
      "cpc %B[remainder], %B[b]\n\t"
      "brcs 3f\n"
      "2:\n\t"
      "sub %A[remainder], %A[b]\n\t"
      "sbc %B[remainder], %B[b]\n\t"
      "inc %A[a]\n"
      "3:\n\t"
      "dec %[bits]\n\t"
      "brne 1b\n\t"
      : [a] "+r"(a), [remainder] "+r"(remainder), [bits] "+r"(bits)
      : [b] "r"(b));
  return a;
}

}  // namespace detail
#endif

/// floor(a / b) when it fits 16 bits: the upper half of a must be less than b.
SCREED_OUT_OF_LINE inline uint16_t quotient_u16(uint32_t a, uint16_t b) {
#ifdef __AVR__
  return static_cast<uint16_t>(detail::divide(a, b, 16));
#else
  return static_cast<uint16_t>(a / b);
#endif
}

/// floor(a / b), b > 0.
inline uint32_t quotient_u32(uint32_t a, uint16_t b) {
#ifdef __AVR__
  return detail::divide(a, b, 32);
#else
  return a / b;
#endif
}

}  // namespace screed
