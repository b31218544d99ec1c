// Trigonometry on binary angles. Polynomials, no tables: nothing to keep in flash or, worse, in the
// AVR's SRAM.
#pragma once

#include <stdint.h>

#include "firmware/math/fixed.h"

namespace screed {

/// A plane angle, 65536 units = one turn; sums and differences wrap (wrap_angle), so -32768 is half
/// a turn.
using Angle = int16_t;

constexpr Angle kQuarterTurn = 16384;

/// The angle that is the same direction as `units` (65536 = one turn).
constexpr Angle wrap_angle(int32_t units) {
  return static_cast<Angle>(static_cast<uint16_t>(static_cast<uint32_t>(units) & 0xFFFFU));
}

/// a - b the short way round, in [-32768, 32767].
constexpr Angle angle_difference(Angle a, Angle b) {
  return wrap_angle(static_cast<int32_t>(a) - static_cast<int32_t>(b));
}

/// sin(angle) in Q15, within 1 unit (2^-15) of the true value; the value 1 is 32767. Odd: sin(-a)
/// == -sin(a).
int16_t sin_q15(Angle angle);

/// cos(angle) in Q15; as sin_q15.
int16_t cos_q15(Angle angle);

/// Direction of the vector (x, y), counter-clockwise from x, within 1 unit (0.0055 degree) of the
/// true value. Any pair is allowed; (0, 0) gives 0; y = 0 and x < 0 gives -32768.
Angle atan2_angle(int32_t y, int32_t x);

/// Turns a vector counter-clockwise by an angle. Its length must be less than 2^15.
void turn_vector(int16_t (&vector)[2], Angle by);
/// Clockwise.
void turn_vector_back(int16_t (&vector)[2], Angle by);

}  // namespace screed
