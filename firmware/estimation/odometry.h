// Dead reckoning: encoder counts and heading to a position on the plane.
//
// The heading comes from the attitude estimator, not from the difference of the tracks: skid
// steering makes the latter useless (thesis 4.3.1). Track travel is along the slope; its horizontal
// part counts.
#pragma once

#include <stdint.h>

#include "firmware/math/trig.h"

namespace screed {

class Odometry {
 public:
  /// count_um_q4: track travel per encoder count, 1/16 um.
  explicit Odometry(uint16_t count_um_q4) : count_um_q4_(count_um_q4) {}

  /// Back to the origin.
  void reset();

  /// One tick: counts of both tracks since the last tick (limited to kMaxTrackCounts), heading and
  /// pitch now.
  void update(int16_t counts_left, int16_t counts_right, Angle heading, Angle pitch);

  /// Position relative to the place of the last reset, mm; x is east, y north. Stops at
  /// +-2147 m.
  int32_t x_mm() const;
  int32_t y_mm() const;

 private:
  uint16_t count_um_q4_;
  int32_t x_um_ = 0;
  int32_t y_um_ = 0;
};

}  // namespace screed
