// Dead reckoning.
#include "firmware/estimation/odometry.h"

#include "firmware/math/fixed.h"
#include "firmware/parameters/board_constants.h"

namespace screed {
namespace {

/// length * factor (Q15), rounded; |length| below 2^30.
int32_t times_q15(int32_t length, int16_t factor) {
  return scale_q16(length * 2, factor);
}

/// um / 1000, towards zero.
SCREED_OUT_OF_LINE int32_t mm_from_um(int32_t um) {
  const auto mm = static_cast<int32_t>(quotient_u32(abs_u32(um), 1000));
  return um < 0 ? -mm : mm;
}

}  // namespace

void Odometry::reset() {
  x_um_ = 0;
  y_um_ = 0;
}

void Odometry::update(int16_t counts_left, int16_t counts_right, Angle heading, Angle pitch) {
  const int32_t counts =
      static_cast<int32_t>(clamp_i16(counts_left, -kMaxTrackCounts, kMaxTrackCounts)) +
      clamp_i16(counts_right, -kMaxTrackCounts, kMaxTrackCounts);
  // Mean of both tracks: half the sum; Q4 and the half together are a shift by 5.
  const int32_t travel_um = asr_round(counts * static_cast<int32_t>(count_um_q4_), 5);
  const int32_t horizontal_um = times_q15(travel_um, cos_q15(pitch));
  x_um_ = add_sat_i32(x_um_, times_q15(horizontal_um, cos_q15(heading)));
  y_um_ = add_sat_i32(y_um_, times_q15(horizontal_um, sin_q15(heading)));
}

int32_t Odometry::x_mm() const {
  return mm_from_um(x_um_);
}
int32_t Odometry::y_mm() const {
  return mm_from_um(y_um_);
}

}  // namespace screed
