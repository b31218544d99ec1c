// Fixed-point quaternion algebra, written to be small and quick on an 8-bit multiplier: 16-bit
// factors, and shifts by 16 bits wherever the formats allow it.
#include "firmware/math/quaternion.h"

#include "firmware/math/fixed.h"

namespace screed {

namespace {

/// A Q30 component, at most 1 in magnitude, as Q14, rounded.
int16_t q14_from_q30(int32_t value) {
  return detail::high_half(value + 0x8000);
}

/// 2 sum in Q14, rounded, of a sum of two Q14 x Q14 products; |sum| <= 1.
int16_t twice(int32_t sum) {
  return detail::high_half(sum * 8 + 0x8000);
}

}  // namespace

Quaternion scaled_product(const Quaternion& q, const SmallQuaternion& change) {
  const auto times = [](int32_t a, int16_t b) { return scale_q16(a, b); };
  return {
      times(q.w, change.w) - times(q.x, change.x) - times(q.y, change.y) - times(q.z, change.z),
      times(q.w, change.x) + times(q.x, change.w) + times(q.y, change.z) - times(q.z, change.y),
      times(q.w, change.y) - times(q.x, change.z) + times(q.y, change.w) + times(q.z, change.x),
      times(q.w, change.z) + times(q.x, change.y) - times(q.y, change.x) + times(q.z, change.w)};
}

RotationMatrix rotation_matrix(const Quaternion& q) {
  constexpr int32_t kHalf = static_cast<int32_t>(1) << 27;  // Q28
  const int16_t w = q14_from_q30(q.w);
  const int16_t x = q14_from_q30(q.x);
  const int16_t y = q14_from_q30(q.y);
  const int16_t z = q14_from_q30(q.z);
  const int32_t xx = mul_i16(x, x);
  const int32_t yy = mul_i16(y, y);
  const int32_t zz = mul_i16(z, z);
  const int32_t xy = mul_i16(x, y);
  const int32_t xz = mul_i16(x, z);
  const int32_t yz = mul_i16(y, z);
  const int32_t wx = mul_i16(w, x);
  const int32_t wy = mul_i16(w, y);
  const int32_t wz = mul_i16(w, z);
  return {{{twice(kHalf - yy - zz), twice(xy - wz), twice(xz + wy)},
           {twice(xy + wz), twice(kHalf - xx - zz), twice(yz - wx)},
           {twice(xz - wy), twice(yz + wx), twice(kHalf - xx - yy)}}};
}

int16_t length_deficit_q24(const Quaternion& q) {
  // A square in Q28 from halves: (h 2^16 + l)^2 / 2^32 = h^2 + h l / 2^15 + l^2 / 2^32, the last
  // below one unit.
  const int32_t component[4] = {q.w, q.x, q.y, q.z};
  int32_t deficit = static_cast<int32_t>(1) << 28;
  for (uint8_t i = 0; i < 4; ++i) {
    const int16_t high = detail::high_half(component[i]);
    const uint16_t low = detail::low_half(component[i]);
    deficit -= mul_i16(high, high) + detail::high_half(detail::mul_su(high, low)) * 2;
  }
  return saturate_i16(asr_round(deficit, 5));
}

int32_t dot_q14(const int16_t (&row)[3], const int16_t (&v)[3]) {
  return mul_i16(row[0], v[0]) + mul_i16(row[1], v[1]) + mul_i16(row[2], v[2]);
}

}  // namespace screed
