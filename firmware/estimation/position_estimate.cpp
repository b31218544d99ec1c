// Where the robot is, and how well it knows.
#include "firmware/estimation/position_estimate.h"

#include "firmware/math/fixed.h"
#include "firmware/math/sqrt.h"
#include "firmware/parameters/board_constants.h"

namespace screed {
namespace {

// What both tracks travel is booked as variance in pieces of 128 mm each, counted in 16 um.
constexpr uint16_t kBooked = 16000;

/// length * factor (Q15), rounded; |length| below 2^30.
int32_t times_q15(int32_t length, int16_t factor) {
  return scale_q16(length * 2, factor);
}

}  // namespace

void PositionEstimate::reset() {
  static_cast<PositionState&>(*this) = PositionState();
}

void PositionEstimate::update(int16_t counts_left, int16_t counts_right, Angle heading, Angle pitch,
                              uint8_t share) {
  const int16_t left = clamp_i16(counts_left, -kMaxTrackCounts, kMaxTrackCounts);
  const int16_t right = clamp_i16(counts_right, -kMaxTrackCounts, kMaxTrackCounts);
  // Mean of both tracks: half the sum; Q4, the half and the share together are a shift by 13, of
  // which 16 - 3 are in the scaling. 2^-10 mm are 1.024 a um: 131 / 128, less 0.05 %.
  const int32_t both = static_cast<int16_t>(left + right) * static_cast<int32_t>(count_um_q4_);
  const auto scale = static_cast<int16_t>(static_cast<uint16_t>((share + 1) * 131) >> 1);
  const int32_t travel = asr(scale_q16(both, scale), 3);
  const int32_t horizontal = times_q15(travel, cos_q15(pitch));
  place_[kX] = add_sat_i32(place_[kX], times_q15(horizontal, cos_q15(heading)));
  place_[kY] = add_sat_i32(place_[kY], times_q15(horizontal, sin_q15(heading)));

  // Of both tracks, so that a turn on the spot makes the place uncertain as well.
  travel_ = static_cast<uint16_t>(travel_ + static_cast<uint8_t>(abs_i16(left) + abs_i16(right)) *
                                                static_cast<uint16_t>(count_um_q4_ >> 8));
  if (travel_ < kBooked) return;
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

uint16_t PositionEstimate::sigma_mm(uint8_t axis) const {
  return static_cast<uint16_t>(isqrt32(static_cast<uint32_t>(variance_[axis]) << 4));
}

}  // namespace screed
