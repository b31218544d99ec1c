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

bool PositionEstimate::measure(uint8_t axis, int16_t z_mm, int16_t sigma_mm) {
  const int16_t innovation = limit_i16(z_mm - mm(axis), INT16_MAX);
  const uint16_t variance = variance_[axis];
  // Halves, so that the sum fits.
  const auto sum = static_cast<uint16_t>((variance >> 1) +
                                         static_cast<uint16_t>(mul_i16(sigma_mm, sigma_mm) >> 5));
  if (static_cast<uint32_t>(mul_i16(innovation, innovation)) >> 5 > mul_u16(sum, 9)) return false;
  // Below 1: sigma_mm is at least 4.
  const auto gain_q15 =
      static_cast<int16_t>(quotient_u16(static_cast<uint32_t>(variance >> 1) << 15, sum));
  place_[axis] += mul_i16(innovation, gain_q15) >> 5;
  variance_[axis] =
      static_cast<uint16_t>(variance - (mul_u16(variance, static_cast<uint16_t>(gain_q15)) >> 15));
  return true;
}

void PositionEstimate::mark() {
  for (uint8_t axis = 0; axis < 2; ++axis) marked_[axis] = place_[axis];
}

void PositionEstimate::return_to_mark() {
  for (uint8_t axis = 0; axis < 2; ++axis) place_[axis] = marked_[axis];
}

int32_t PositionEstimate::mm(uint8_t axis) const {
  return asr(place_[axis], 10);
}

uint16_t PositionEstimate::sigma_mm() const {
  const uint16_t greater = variance_[kX] > variance_[kY] ? variance_[kX] : variance_[kY];
  return static_cast<uint16_t>(isqrt32(static_cast<uint32_t>(greater) << 4));
}

}  // namespace screed
