// Says whether the tracks move the robot: slip and stuck, from what it has on board.
//
// A network (nn/models/slip.json, in nn/infer's integers) predicts 50 times a second whether the
// robot hardly moves. Its inputs are how far the belts' speed departs from what the accelerometer
// measured since the tracks stood (over 2.6 and 10 s, since more would be drift), the turn that the
// gyro measures and the difference of the tracks that ought to make one, the belts' speed, the
// slope, what the motors need beyond idling (a robot that hangs needs little), how much the
// chassis vibrates (one that stands does not) and how it pitches (one that digs itself in does so
// slowly). The mean of its outputs over a third of a second sets the flags. docs/networks.md has
// figures, `screed nn stuck` measures them.
#pragma once

#include <stdint.h>

#include "firmware/control/track_motion.h"
#include "firmware/math/fixed.h"

namespace screed {

constexpr uint8_t kSlipInputs = 11;

/// What the watch remembers, zero at the start.
struct SlipMemory {
  /// Vibration of an axis, its mean removed.
  struct Vibration {
    int32_t mean;        // 64 times the mean over 0.64 s
    int16_t band_pass;   // 4 times what differs from the mean, smoothed over 4 ticks
    uint16_t magnitude;  // 64 times the mean of its absolute value
  };

  int32_t mean_;  // of what enters velocity_loss_ when nothing slips: bias, error of the pitch; Q9
  int32_t velocity_loss_[2];  // belts' speed minus that by inertia; about 0.05 mm/s
  uint16_t faster_track_;     // track's speed, 0.1 mm/s
  int16_t yaw_rate_;          // smoothed, a quarter
  int16_t effort_;            // smoothed, Q4 duty
  int16_t half_speed_;        // of the belts in the tick before, half of 0.1 mm/s
  uint16_t evidence_;         // mean of held_, 0..65535
  bool stuck_;
  // clang-format off
  // Inputs of the network. Signs are for driving ahead; "share" is over the faster track's speed,
  // Q14.
  //   0    belts' speed minus inertial speed, over 2.6 s, share
  //   1    the same over 10 s
  //   2    |yaw rate| as speed of a track, share
  //   3    half the difference of the tracks, share
  //   4    faster track, 0.2 mm/s
  //   5    sine of the pitch, Q14
  //   6    effort of both tracks, 1/16 duty
  //   7-9  vibration of pitch rate, force ahead, force up, 1/128 count
  //   10   mean pitch rate, 1/64 count
  // clang-format on
  int16_t inputs_[kSlipInputs];
  int16_t held_;            // the network's output, Q15: -1 it moves, 1 it hardly does
  Vibration vibration_[3];  // pitch rate, specific force ahead, up
};

class SlipWatch : private SlipMemory {
 public:
  // 126 = 40 pi = 10 (0.1 mm) x 4 (quartered rate) x pi (B/2 x 2 pi / 65536, Q16)
  explicit SlipWatch(uint16_t tread_mm)
      : SlipMemory(), arc_q16_(static_cast<uint16_t>(tread_mm * 126U)) {}

  /// One tick. gyro, accel: the three counts (70 mdps, 0.244 mg) as they come; sin_pitch_q14 > 0:
  /// nose up; yaw_rate: angle units/s. The network is asked when `classify_now` is set, in every
  /// second tick: those in which no command's MAC is checked, so that the longest tick stays as
  /// long as it is. A robot whose tracks stand gives no evidence and is not stuck.
  SCREED_OUT_OF_LINE void tick(const TrackMotion& left, const TrackMotion& right,
                               const int16_t* gyro, const int16_t* accel, int16_t sin_pitch_q14,
                               int32_t yaw_rate, bool classify_now);

  /// The tracks move much more than the robot.
  bool slips() const;
  /// They have done so for long: the robot is dug in or hangs. Until it moves or the tracks stop.
  bool stuck() const { return stuck_; }

  // For training and tests.
  const int16_t* network_inputs() const { return inputs_; }
  uint16_t evidence() const { return evidence_; }

  static constexpr int16_t kMinTrackSpeed_dmm_per_s = 350;  ///< below, slip is not observable

 private:
  static void update_vibration(Vibration& vibration, int16_t counts);
  int16_t velocity_loss_share(uint8_t which, bool backwards) const;
  SCREED_OUT_OF_LINE void classify(int16_t half_left, int16_t half_right, int16_t sin_pitch_q14);

  uint16_t arc_q16_;  ///< 0.1 mm/s at the track per four units of yaw rate
};

}  // namespace screed
