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

// Products of an orientation and a change, each of the 16 terms rounded to nearest in 16 digits
// more than the change has. The length of the change must be below 32768, that of q at most 1.9.

/// q += q change, a change in Q17 as the sensor sees it; rounded down.
void turn_by_sensor(Quaternion& q, const SmallQuaternion& change);

/// q += change q, a change in Q24 as it is seen from the earth; rounded to nearest.
void turn_by_earth(Quaternion& q, const SmallQuaternion& change);

/// q = rotation q, a rotation in Q15 as it is seen from the earth.
void turn_at_once(Quaternion& q, const SmallQuaternion& rotation);

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
