// Unit quaternions and rotation matrices in fixed point. Knows nothing of sensors.
// Convention: Hamilton product, an orientation q turns sensor coordinates into earth coordinates,
// v_e = q v_s q*.
#pragma once

#include <stdint.h>

namespace screed {

/// Four components in Q30. A rotation has length 1.
struct Quaternion {
  int32_t w;
  int32_t x;
  int32_t y;
  int32_t z;
};

/// The components in their order, for loops.
inline int32_t* components(Quaternion& q) {
  return &q.w;
}
inline const int32_t* components(const Quaternion& q) {
  return &q.w;
}

constexpr Quaternion kIdentityQuaternion = {static_cast<int32_t>(1) << 30, 0, 0, 0};

/// A small change of an orientation: what is added to the quaternion 1, all four below 1/2 in the
/// scale it is used in.
struct SmallQuaternion {
  int16_t w;
  int16_t x;
  int16_t y;
  int16_t z;
};

/// Rotation matrix by rows, sensor to earth. Elements in Q14: the value 1 is 16384.
struct RotationMatrix {
  int16_t row[3][3];
};

/// Hamilton product q change / 2^16, each of its 16 terms rounded to nearest: Q30 in, Q(30 + n -
/// 16) out for a change in Qn. The length of the change must be below 32768, that of q at most 1.9.
Quaternion scaled_product(const Quaternion& q, const SmallQuaternion& change);

/// change q / 2^16, likewise: a change seen from the earth.
Quaternion scaled_reverse_product(const SmallQuaternion& change, const Quaternion& q);

/// The matrix of a unit quaternion; error of an element below 4 units (2.4e-4).
RotationMatrix rotation_matrix(const Quaternion& q);

/// (1 - |q|^2) / 2 in Q24: what q has to grow by to have length 1, to first order. Clamped to
/// int16; error 1e-4.
int16_t length_deficit_q24(const Quaternion& q);

/// |v|^2, right for every v.
uint32_t squared_length(const int16_t (&v)[3]);

/// row . v: raw counts turned by a rotation matrix, in counts with 14 binary digits. Fits 32 bits
/// for every v.
int32_t dot_q14(const int16_t (&row)[3], const int16_t (&v)[3]);

}  // namespace screed
