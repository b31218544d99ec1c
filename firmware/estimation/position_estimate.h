// Where the robot is on the plane, and how well it knows: dead reckoning from encoder counts and
// heading, corrected by position fixes and by walls that it touches.
//
// The heading comes from the attitude estimator, not from the difference of the tracks: skid
// steering makes the latter useless (thesis 4.3.1). Track travel is along the slope; its horizontal
// part counts, and of that the share that the tracks do not lose by slip.
//
// Each axis is a Kalman filter of one state. Slip makes the position drift like a random walk, so
// the variance grows with what the tracks travel:
//   variance += noise |travel|
// and with a measurement z of the variance r
//   k = variance / (variance + r),  x += k (z - x),  variance -= k variance
#pragma once

#include <stdint.h>

#include "firmware/math/trig.h"

namespace screed {

/// Zero after a reset.
struct PositionState {
  int32_t place_[2];      ///< 2^-10 mm
  uint16_t variance_[2];  ///< 16 mm^2: up to 1 m of standard deviation
  uint16_t travel_;       ///< of both tracks, not booked as variance yet, 16 um
};

class PositionEstimate : private PositionState {
 public:
  /// count_um_q4: track travel per encoder count, 1/16 um. noise: variance of the position that a
  /// metre of travel makes, 125 mm^2.
  PositionEstimate(uint16_t count_um_q4, int16_t noise)
      : PositionState(), count_um_q4_(count_um_q4), noise_(static_cast<uint16_t>(noise)) {}

  /// At the origin for sure.
  void reset();

  /// One tick: counts of both tracks since the last tick (limited to kMaxTrackCounts), heading and
  /// pitch now; share: of the tracks' travel that moves the robot, 255: all of it.
  void update(int16_t counts_left, int16_t counts_right, Angle heading, Angle pitch, uint8_t share);

  enum Axis : uint8_t { kX, kY };

  /// Measured along an axis: z_mm, +-sigma_mm (8..1000). False, and nothing changed, where that is
  /// further off than three standard deviations.
  bool measure(uint8_t axis, int16_t z_mm, int16_t sigma_mm);
  /// Measured from outside, +-sigma_mm: who sends this has left out what is false.
  void fix(int16_t x_cm, int16_t y_cm, int16_t sigma_mm);

  /// Position relative to the place of the last reset, or in the frame of the fixes, mm; x is east,
  /// y north. Stops at +-2097 m.
  int32_t x_mm() const { return mm(kX); }
  int32_t y_mm() const { return mm(kY); }
  SCREED_OUT_OF_LINE int32_t mm(uint8_t axis) const;
  /// Standard deviation along an axis, mm; 1020: that, or more.
  SCREED_OUT_OF_LINE uint16_t sigma_mm(uint8_t axis) const;

 private:
  SCREED_OUT_OF_LINE void blend(uint8_t axis, int16_t innovation, int16_t sigma_mm);

  uint16_t count_um_q4_;
  uint16_t noise_;  ///< 125 mm^2 a metre: 16 mm^2 for 128 mm
};

}  // namespace screed
