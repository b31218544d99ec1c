// Where the robot is, and how well it knows.
#include "firmware/estimation/position_estimate.h"

#include "firmware/math/fixed.h"
#include "firmware/math/sqrt.h"
#include "firmware/parameters/board_constants.h"

namespace screed {
namespace {

// Travel is booked as variance in pieces of 2^17 of its units: 128 mm.
constexpr uint8_t kBookedShift = 17;

/// length * factor (Q15), rounded; |length| below 2^30.
int32_t times_q15(int32_t length, int16_t factor) {
  return scale_q16(length * 2, factor);
}

}  // namespace

// 2^-14 mm in 1/16 um: 1.024 = 1 + 3 / 125. drift^2 mm^2 a metre; of that 128 mm in units of 16
// mm^2 are 1 / 125. It is rounded up: no drift at all would be a lie.
PositionEstimate::PositionEstimate(uint16_t count_um_q4, int16_t drift_mm)
    : PositionState(),
      count_q4_(static_cast<uint16_t>(count_um_q4 + (count_um_q4 * 3UL + 62) / 125)),
      noise_(static_cast<uint16_t>(quotient_u32(
          mul_u16(static_cast<uint16_t>(drift_mm), static_cast<uint16_t>(drift_mm)) + 124, 125))) {}

void PositionEstimate::reset() {
  static_cast<PositionState&>(*this) = PositionState();
}

void PositionEstimate::update(int16_t counts_left, int16_t counts_right, Angle heading, Angle pitch,
                              uint8_t share) {
  const int16_t left = clamp_i16(counts_left, -kMaxTrackCounts, kMaxTrackCounts);
  const int16_t right = clamp_i16(counts_right, -kMaxTrackCounts, kMaxTrackCounts);
  // Mean of both tracks: half the sum; Q4, the half and the share together are a shift by 13. 100
  // counts of 4 mm fit.
  const auto counts = static_cast<int16_t>(left + right);
  const int32_t travel = asr_round(
      scale_q16(counts * static_cast<int32_t>(count_q4_), static_cast<int16_t>((share + 1) * 64)),
      3);
  const int32_t horizontal = times_q15(travel, cos_q15(pitch));
  place_[kX] = add_sat_i32(place_[kX], times_q15(horizontal, cos_q15(heading)));
  place_[kY] = add_sat_i32(place_[kY], times_q15(horizontal, sin_q15(heading)));

  // Of both tracks, so that a turn on the spot makes the place uncertain as well.
  travel_ += mul_u16(static_cast<uint16_t>(abs_i16(left) + abs_i16(right)), count_q4_) >> 5;
  if (travel_ >> kBookedShift == 0) return;
  travel_ = 0;
  for (uint16_t& variance : variance_) {
    const auto sum = static_cast<uint16_t>(variance + noise_);
    variance = sum < variance ? static_cast<uint16_t>(UINT16_MAX) : sum;
  }
}

void PositionEstimate::blend(uint8_t axis, int16_t innovation, int16_t sigma_mm) {
  const uint16_t half = variance_[axis] >> 1;
  const auto sum =
      static_cast<uint16_t>(half + static_cast<uint16_t>(mul_i16(sigma_mm, sigma_mm) >> 5));
  // Below 1: sigma_mm is at least 8.
  const uint16_t gain_q15 = quotient_u16(static_cast<uint32_t>(half) << 15, sum);
  place_[axis] += asr(mul_i16(innovation, static_cast<int16_t>(gain_q15)), 5);
  variance_[axis] =
      static_cast<uint16_t>(variance_[axis] - static_cast<uint16_t>(mul_u16(half, gain_q15) >> 14));
}

bool PositionEstimate::measure(uint8_t axis, int16_t z_mm, int16_t sigma_mm) {
  const int16_t innovation = limit_i16(z_mm - mm(axis), INT16_MAX);
  // innovation^2 > 9 (variance + r), all of it over 32: 4.5 and 9 / 32, about.
  if (static_cast<uint32_t>(mul_i16(innovation, innovation)) >> 5 >
      mul_u16(variance_[axis], 5) + (static_cast<uint32_t>(mul_i16(sigma_mm, sigma_mm)) >> 2))
    return false;
  blend(axis, innovation, sigma_mm);
  return true;
}

void PositionEstimate::fix(int16_t x_cm, int16_t y_cm, int16_t sigma_mm) {
  blend(kX, limit_i16(x_cm * 10 - mm(kX), INT16_MAX), sigma_mm);
  blend(kY, limit_i16(y_cm * 10 - mm(kY), INT16_MAX), sigma_mm);
}

int32_t PositionEstimate::mm(uint8_t axis) const {
  return asr(place_[axis], 10);
}

uint16_t PositionEstimate::sigma_mm() const {
  const uint16_t greater = variance_[kX] > variance_[kY] ? variance_[kX] : variance_[kY];
  return static_cast<uint16_t>(isqrt32(static_cast<uint32_t>(greater) << 4));
}

}  // namespace screed
