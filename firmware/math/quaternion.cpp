// Fixed-point quaternion algebra, written to be small and quick on an 8-bit multiplier: 16-bit
// factors, and shifts by 16 bits wherever the formats allow it.
#include "firmware/math/quaternion.h"

#include "firmware/math/fixed.h"

namespace screed {

namespace {

/// 2 sum in Q14, rounded, of a sum of two Q14 x Q14 products; |sum| <= 1.
SCREED_OUT_OF_LINE int16_t twice(int32_t sum) {
  return detail::high_half(sum * 8 + 0x8000);
}

// Component i of a product is the sum of all +-a[j] b[i ^ j]; written out that is 450 bytes longer
// and 600 cycles shorter. Bit 4 i + j: the term is subtracted.
constexpr uint16_t kMinusOfProduct = 0x428E;
constexpr uint16_t kMinusOfReverseProduct = 0x284E;

/// How a product becomes part of an orientation.
enum Turn : uint8_t {
  kAddHalf,  ///< half of it is added, rounded down
  kAddPart,  ///< 2^-8 of it is added, rounded to nearest
  kReplace,  ///< twice of it is the orientation
};

SCREED_OUT_OF_LINE void turn(Quaternion& q, const SmallQuaternion& change, uint16_t minus,
                             Turn how) {
  static_assert(
      sizeof(Quaternion) == 4 * sizeof(int32_t) && sizeof(SmallQuaternion) == 4 * sizeof(int16_t),
      "components lie side by side");
  const Quaternion before = q;
  const int32_t* const a = components(before);
  const int16_t* const b = &change.w;
  int32_t* at = components(q);
  for (uint8_t i = 0; i < 4; ++i, ++at) {
    int32_t sum = 0;
    for (uint8_t j = 0; j < 4; ++j, minus = static_cast<uint16_t>(minus >> 1)) {
      const int32_t term = scale_q16(a[j], b[i ^ j]);
      sum = (minus & 1U) != 0 ? sum - term : sum + term;
    }
    *at = how == kReplace ? sum * 2 : how == kAddHalf ? *at + asr(sum, 1) : *at + asr_round(sum, 8);
  }
}

}  // namespace

void turn_by_sensor(Quaternion& q, const SmallQuaternion& change) {
  turn(q, change, kMinusOfProduct, kAddHalf);
}

void turn_by_earth(Quaternion& q, const SmallQuaternion& change) {
  turn(q, change, kMinusOfReverseProduct, kAddPart);
}

void turn_at_once(Quaternion& q, const SmallQuaternion& rotation) {
  turn(q, rotation, kMinusOfReverseProduct, kReplace);
}

RotationMatrix rotation_matrix(const Quaternion& q) {
  // In Q14, rounded: w, x, y, z, x, y. Of the axes a, b and c = x, y, z; y, z, x; z, x, y element
  // (a, a) is 1 - 2 (b b + c c), and (b, a) and (a, b) are 2 (a b + w c) and 2 (a b - w c).
  int16_t part[6];
  for (uint8_t i = 0; i < 4; ++i) part[i] = detail::high_half(components(q)[i] + 0x8000);
  part[4] = part[1];
  part[5] = part[2];
  constexpr int32_t kHalf = static_cast<int32_t>(1) << 27;  // Q28
  RotationMatrix matrix;
  for (uint8_t i = 0; i < 3; ++i) {
    int16_t* const diagonal = &matrix.row[i][i];
    int16_t* const below = i == 2 ? &matrix.row[0][2] : &matrix.row[i + 1][i];
    int16_t* const right = i == 2 ? &matrix.row[2][0] : &matrix.row[i][i + 1];
    const int16_t a = part[i + 1];
    const int16_t b = part[i + 2];
    const int16_t c = part[i + 3];
    *diagonal = twice(kHalf - (mul_i16(b, b) + mul_i16(c, c)));
    const int32_t ab = mul_i16(a, b);
    const int32_t wc = mul_i16(part[0], c);
    *below = twice(ab + wc);
    *right = twice(ab - wc);
  }
  return matrix;
}

int16_t length_deficit_q24(const Quaternion& q) {
  // A square in Q28 from halves: (h 2^16 + l)^2 / 2^32 = h^2 + h l / 2^15 + l^2 / 2^32, the last
  // below one unit.
  const int32_t* const component = components(q);
  int32_t deficit = static_cast<int32_t>(1) << 28;
  for (uint8_t i = 0; i < 4; ++i) {
    const int16_t high = detail::high_half(component[i]);
    const uint16_t low = detail::low_half(component[i]);
    deficit -= mul_i16(high, high);
    deficit -= detail::high_half(detail::mul_su(high, low)) * 2;
  }
  return saturate_i16(asr_round(deficit, 5));
}

int32_t dot_q14(const int16_t (&row)[3], const int16_t (&v)[3]) {
  uint32_t sum = 0;  // wraps where it is a squared length
  for (uint8_t i = 0; i < 3; ++i) sum += static_cast<uint32_t>(mul_i16(row[i], v[i]));
  return static_cast<int32_t>(sum);
}

uint32_t squared_length(const int16_t (&v)[3]) {
  return static_cast<uint32_t>(dot_q14(v, v));
}

}  // namespace screed
