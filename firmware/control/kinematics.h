// Kinematics of a skid-steer robot (thesis 5.1.2): body motion to track speeds. Knows
// nothing of slip.
#pragma once

#include <stdint.h>

#include "firmware/math/units.h"

namespace screed {

/// What the robot's body is to do.
struct MotionCommand {
  int16_t speed_mm_per_s;  ///< forward positive
  YawRate yaw_rate;        ///< counter-clockwise positive
};

/// Speeds of the tracks over the ground without slip, mm/s, forward positive.
struct TrackSpeeds {
  int16_t left;
  int16_t right;
};

class SkidSteer {
 public:
  /// tread_mm: distance between the tracks' centre lines (the thesis' wheel base B), 1..300.
  explicit SkidSteer(uint16_t tread_mm)
      : half_arc_q22_(static_cast<uint16_t>(tread_mm * 201U)) {}  // 2^6 pi, less 0.03 %

  /// Thesis 5.1.2 without the division by the wheel radius: left = l - B w / 2, right = l + B w
  /// / 2. When a track would pass `limit_mm_per_s`, the forward speed is reduced first, so that the
  /// turn stays as commanded whenever it can be made at all.
  TrackSpeeds tracks(int16_t speed_mm_per_s, int32_t yaw_rate, int16_t limit_mm_per_s) const;

 private:
  uint16_t half_arc_q22_;  ///< B/2 * 2 pi / 65536 in Q22: mm/s at the track per unit of yaw rate
};

// A track as its speed control knows it: what the slip watch asks of the control.

struct TrackMotion {
  int16_t speed_dmm_per_s;  ///< observed, 0.1 mm/s
  int16_t effort;           ///< duty beyond what drives the unloaded track
};

}  // namespace screed
