// Says whether the tracks move the robot: slip and stuck, from what it has on board.
//
// A network (nn/models/slip.json, in nn/infer's integers) foretells 50 times a second whether the
// robot hardly moves. It sees how far the belts' speed has come away from what the accelerometer
// felt since the tracks stood (over 2.6 and 10 s, since more would be drift), the turn that the
// gyro measures and the difference of the tracks that ought to make one, the belts' speed, the
// slope, what the motors need beyond idling (a robot that hangs needs little), how much the
// chassis shakes (one that stands does not) and how it pitches (one that digs itself in does so
// slowly). A mean of its answers over a third of a second makes the flags. docs/networks.md has
// figures, `screed nn stuck` measures them.
#pragma once

#include <stdint.h>

#include "firmware/math/fixed.h"

namespace screed {

constexpr uint8_t kSlipInputs = 11;

/// A track as its control knows it.
struct TrackMotion {
  int16_t speed_dmm_per_s;  ///< observed, 0.1 mm/s
  int16_t effort;           ///< duty beyond what drives the unloaded track
};

/// What the watch remembers, zero at the start.
struct SlipMemory {
  /// What an axis says, its mean taken off.
  struct Shake {
    int32_t slow;     // 64 times the mean over 0.64 s
    int16_t quick;    // 4 times the rest, smoothed over 4 ticks
    uint16_t amount;  // 64 times the mean of its amount
  };

  int32_t mean_;        // of what comes into lost_ when nothing slips: bias, error of the pitch; Q9
  int32_t lost_[2];     // belts' speed minus that by inertia; about 0.05 mm/s
  uint16_t faster_;     // track's speed, 0.1 mm/s
  int16_t yaw_rate_;    // smoothed, a quarter
  int16_t effort_;      // smoothed, Q4 duty
  int16_t half_speed_;  // of the belts in the tick before, half of 0.1 mm/s
  uint16_t evidence_;   // mean of held_, 0..65535
  bool stuck_;
  // What the network sees; shares of the faster track's speed are Q14, signs are for driving ahead.
  //   0, 1  belts' speed minus speed by inertia, share    5  sine of the pitch, Q14
  //   2  the turn, as speed of a track, share             6  effort of both tracks, 2^-4 duty
  //   3  half the difference of the tracks, share         7, 8, 9  shaking: pitch rate, ahead, up;
  //   4  faster track, 0.2 mm/s                              2^-7 counts
  //                                                       10  mean pitch rate, 2^-6 counts
  int16_t inputs_[kSlipInputs];
  int16_t held_;    // the network's answer, Q15: -1 it moves, 1 it hardly does
  Shake shake_[3];  // pitch rate, specific force ahead, up
};

class SlipWatch : private SlipMemory {
 public:
  explicit SlipWatch(uint16_t tread_mm)
      : SlipMemory(), arc_q16_(static_cast<uint16_t>(tread_mm * 126U)) {}  // 126 = pi / 2 * 10 * 8

  /// One tick. gyro, accel: the three counts (70 mdps, 0.244 mg) as they come; sin_pitch_q14 > 0:
  /// nose up; yaw_rate: angle units/s. The network is asked when `judged` says so, in every second
  /// tick: those in which no command's MAC is checked, so that the longest tick stays as long as it
  /// is. A robot whose tracks stand gives no evidence and is not stuck.
  SCREED_OUT_OF_LINE void tick(const TrackMotion& left, const TrackMotion& right,
                               const int16_t* gyro, const int16_t* accel, int16_t sin_pitch_q14,
                               int32_t yaw_rate, bool judged);

  /// The tracks move much more than the robot.
  bool slips() const;
  /// They have done so for long: the robot is dug in or hangs. Until it moves or the tracks stop.
  bool stuck() const { return stuck_; }

  // For training and tests.
  const int16_t* network_inputs() const { return inputs_; }
  int16_t network_output() const { return held_; }
  uint16_t evidence() const { return evidence_; }

  static constexpr int16_t kSlowest_dmm_per_s = 350;  ///< below, nothing can be told

 private:
  static void feel(Shake& shake, int16_t counts);
  int16_t lost_share(uint8_t which, bool back) const;
  SCREED_OUT_OF_LINE void judge(int16_t half_left, int16_t half_right, int16_t sin_pitch_q14);

  uint16_t arc_q16_;  ///< 0.1 mm/s at the track per four units of yaw rate
};

}  // namespace screed
