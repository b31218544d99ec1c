// Says whether the tracks move the robot: slip and stuck, from what it has on board.
//
// A network (nn/models/slip.json, in nn/infer's integers) foretells in every tick the speed over
// the ground as a share of what the encoders say. It sees how far the belts' speed has come away
// from what the accelerometer felt (integrated over a few seconds, since more would be drift), the
// turn that the gyro measures and the difference of the tracks that ought to make one, the belts'
// speed, the slope, and what the motors need beyond idling. Speed foretold and turn measured
// together are the motion; motion far below that of the belts is evidence, which adds up.
// docs/networks.md has figures, `screed nn stuck` measures them.
#pragma once

#include <stdint.h>

#include "firmware/math/fixed.h"

namespace screed {

constexpr uint8_t kSlipInputs = 6;

/// A track as its control knows it.
struct TrackMotion {
  int16_t speed_dmm_per_s;  ///< observed, 0.1 mm/s
  int16_t effort;           ///< duty beyond what drives the unloaded track
};

/// What the watch remembers, zero at the start.
struct SlipMemory {
  // What the network sees: shares of the faster track's speed as Q14, or as said.
  //   0 belts' speed minus speed by inertia     3 faster track, 2^-12 of 0.1 mm/s
  //   1 the turn, as speed of a track           4 sine of the pitch, > 0: uphill the way it drives
  //   2 half the difference of the tracks       5 effort of both tracks, 2^-7 duty
  int16_t inputs_[kSlipInputs];
  int16_t share_q14_;   // the network's answer; 1: the tracks do not slip
  int32_t mean_;        // of what comes into slip_, Q8
  int32_t slip_;        // belts' speed minus that by inertia; about 0.05 mm/s
  int16_t yaw_rate_;    // smoothed, a quarter
  int16_t effort_;      // smoothed, Q4
  int16_t half_speed_;  // of the belts in the tick before, half of 0.1 mm/s
  int16_t evidence_;    // Q10 ticks
  bool stuck_;
};

class SlipWatch : private SlipMemory {
 public:
  explicit SlipWatch(uint16_t tread_mm)
      : SlipMemory(), arc_q16_(static_cast<uint16_t>(tread_mm * 126U)) {}  // 126 = pi / 2 * 10 * 8

  /// One tick. accel_x: specific force forward, 0.244 mg; sin_pitch_q14 > 0: nose up; yaw_rate:
  /// angle units/s. The network is asked when `judge` says so, in every second tick: those in which
  /// no command's MAC is checked, so that the longest tick stays as long as it is. A robot whose
  /// tracks stand gives no evidence and is not stuck.
  SCREED_OUT_OF_LINE void tick(const TrackMotion& left, const TrackMotion& right, int16_t accel_x,
                               int16_t sin_pitch_q14, int32_t yaw_rate, bool judge);

  /// The tracks move much more than the robot.
  bool slips() const;
  /// They have done so for long: the robot is dug in or hangs. Until it moves or the tracks stop.
  bool stuck() const { return stuck_; }

  // For training and tests.
  const int16_t* network_inputs() const { return inputs_; }
  int16_t network_output() const { return share_q14_; }
  int16_t evidence() const { return evidence_; }

  static constexpr int16_t kSlowest_dmm_per_s = 350;  ///< below, nothing can be told

 private:
  uint16_t arc_q16_;  ///< 0.1 mm/s at the track per four units of yaw rate
};

}  // namespace screed
