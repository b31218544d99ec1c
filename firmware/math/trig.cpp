// Trigonometry on binary angles: minimax polynomials on one quadrant or octant, the rest by
// symmetry. The coefficients are least-maximum-error fits (iteratively reweighted least squares);
// with alternating signs every Horner step is a difference of unsigned Q16 fractions, so no bit is
// lost on a sign.
#include "firmware/math/trig.h"

namespace screed {

namespace {

/// a * b / 2^16 rounded to nearest: one factor is a fraction of 65536.
SCREED_OUT_OF_LINE uint16_t fraction_of(uint16_t a, uint16_t b) {
  return static_cast<uint16_t>((mul_u16(a, b) + 0x8000U) >> 16);
}

/// A step of Horner's scheme: coefficient - square * sum, all of them fractions of 65536.
SCREED_OUT_OF_LINE uint16_t horner(uint16_t sum, uint16_t square, uint16_t coefficient) {
  return static_cast<uint16_t>(coefficient - fraction_of(sum, square));
}

/// atan(ratio / 65536) in angle units, 0..8192.
uint16_t atan_first_octant(uint16_t ratio) {
  // atan(q) / (2 pi) = q (0.1591337 - q^2 (0.0525696 - q^2 (0.0286732 - q^2 (0.0135531 - 0.0033176
  // q^2)))), error of the polynomial 0.12 angle units. Coefficients in Q18.
  constexpr uint16_t kC1 = 41716;
  constexpr uint16_t kC3 = 13781;
  constexpr uint16_t kC5 = 7517;
  constexpr uint16_t kC7 = 3553;
  constexpr uint16_t kC9 = 870;
  const uint16_t q2 = fraction_of(ratio, ratio);
  const uint16_t p1 = horner(horner(horner(horner(kC9, q2, kC7), q2, kC5), q2, kC3), q2, kC1);
  const auto product = static_cast<uint16_t>(mul_u16(ratio, p1) >> 16);
  return static_cast<uint16_t>((product + 2U) >> 2);
}

/// smaller / larger as a fraction of 65536, at most 65535. larger > 0, smaller <= larger.
uint16_t ratio_q16(uint32_t smaller, uint32_t larger) {
  // Keep 16 significant bits of the divisor whatever the length is: whole bytes first, they are
  // moves on the AVR.
  while (static_cast<uint8_t>(larger >> 24) == 0) {
    larger <<= 8;
    smaller <<= 8;
  }
  while ((larger & 0x80000000U) == 0) {
    larger <<= 1;
    smaller <<= 1;
  }
  const auto high = static_cast<uint16_t>(smaller >> 16);
  const auto divisor = static_cast<uint16_t>((larger + 0x8000U) >> 16);
  if (divisor == 0) return high;  // it is 2^16
  return high >= divisor ? static_cast<uint16_t>(0xFFFFU) : quotient_u16(smaller, divisor);
}

}  // namespace

int16_t sin_q15(Angle angle) {
  // z = 0..1 for 0..90 degrees: sin(pi/2 z) = z (1 + 0.570791 - z^2 (0.645813 - z^2 (0.079300 -
  // 0.004272 z^2))): the best of the Q16 coefficients near the real fit (0.570791, 0.645893,
  // 0.0794343, 0.0043331), found by trial.
  constexpr uint16_t kC1MinusOne = 37407;  // coefficients in Q16
  constexpr uint16_t kC3 = 42324;
  constexpr uint16_t kC5 = 5197;
  constexpr uint16_t kC7 = 280;
  // z in Q15: twice the angle wraps at half a turn. At 90 degrees the square is 0 in place of 1,
  // which makes the sine too large, and it stops at 32767 as it should.
  const uint16_t z = abs_i16(static_cast<int16_t>(static_cast<uint16_t>(angle) << 1));
  const auto z_q16 = static_cast<uint16_t>(z << 1);
  const uint16_t square = fraction_of(z_q16, z_q16);
  const uint16_t p1 = horner(horner(horner(kC7, square, kC5), square, kC3), square, kC1MinusOne);
  const auto sine = static_cast<uint16_t>(z + fraction_of(z, p1));
  const int16_t magnitude = sine > 32767U ? kQ15One : static_cast<int16_t>(sine);
  return angle < 0 ? static_cast<int16_t>(-magnitude) : magnitude;
}

SCREED_OUT_OF_LINE int16_t cos_q15(Angle angle) {
  return sin_q15(wrap_angle(static_cast<int32_t>(angle) + kQuarterTurn));
}

Angle atan2_angle(int32_t y, int32_t x) {
  uint32_t smaller = abs_u32(y);
  uint32_t larger = abs_u32(x);
  const bool steep = smaller > larger;
  if (steep) {
    const uint32_t of_x = larger;
    larger = smaller;
    smaller = of_x;
  }
  if (larger == 0) return 0;
  uint16_t angle = atan_first_octant(ratio_q16(smaller, larger));
  if (steep) angle = static_cast<uint16_t>(kQuarterTurn - angle);
  if (x < 0) angle = static_cast<uint16_t>(0x8000U - angle);
  if (y < 0) angle = static_cast<uint16_t>(0U - angle);
  return static_cast<Angle>(angle);
}

SCREED_OUT_OF_LINE void turn_vector(int16_t (&vector)[2], Angle by) {
  const int16_t c = cos_q15(by);
  const int16_t s = sin_q15(by);
  const int16_t x = vector[0];
  const int16_t y = vector[1];
  vector[0] = static_cast<int16_t>(asr(mul_i16(x, c) - mul_i16(y, s), 15));
  vector[1] = static_cast<int16_t>(asr(mul_i16(x, s) + mul_i16(y, c), 15));
}

SCREED_OUT_OF_LINE void turn_vector_back(int16_t (&vector)[2], Angle by) {
  turn_vector(vector, static_cast<Angle>(-by));
}

}  // namespace screed
