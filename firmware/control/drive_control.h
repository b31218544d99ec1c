// From a commanded body motion to the duty of both motors: yaw-rate loop, kinematics, speed loops.
//
// A skid-steered track must slip to turn, by an amount the ground decides. So the turn rate is
// closed over the gyro: a PI controller behind a low pass of 1 Hz adds to the commanded rate what
// slip takes away, before the kinematics split it over the tracks. Its integral is the heading lost
// since the robot last stood, so a robot commanded to drive straight ahead returns to its heading.
// Its proportional part is 0 by default: soft ground swings with it.
#pragma once

#include <stdint.h>

#include "firmware/control/kinematics.h"
#include "firmware/control/track_speed_control.h"
#include "firmware/parameters/kept.h"
#include "firmware/parameters/own_board.h"

namespace screed {

struct DriveMeasurement {
  int16_t counts_left;  ///< encoder counts since the last tick
  int16_t counts_right;
  int32_t yaw_rate;  ///< from the gyro, bias removed, angle units/s
  uint16_t battery_mv;
};

struct DriveOutput {
  int16_t duty_left;
  int16_t duty_right;
};

class DriveControl : private OwnBoard {
 public:
  DriveControl(const BoardConstants& board, const Parameters& parameters);

  /// Live parameters (parameters.h), at any time.
  void take(const Parameters& parameters) {
    keep(parameters_, parameters);
    left_.take(parameters);
    right_.take(parameters);
  }

  /// Drives: one tick towards `command`; `at_once`: without the limit of acceleration.
  DriveOutput tick(const MotionCommand& command, const DriveMeasurement& measured,
                   bool at_once = false);

  /// Motors off: keeps observing the tracks, forgets the controllers' state.
  void idle(const DriveMeasurement& measured);

  /// Track speeds asked for after acceleration limit and yaw-rate correction, mm/s.
  const TrackSpeeds& targets() const { return state_.targets; }
  /// Observed track speeds, 0.1 mm/s.
  int16_t speed_left_dmm_per_s() const { return left_.speed_dmm_per_s(); }
  int16_t speed_right_dmm_per_s() const { return right_.speed_dmm_per_s(); }
  const TrackMotion& left() const { return left_.motion(); }
  const TrackMotion& right() const { return right_.motion(); }

 private:
  /// What drive control remembers, zero at the start: zeroed at once, which takes less flash.
  struct State {
    TrackSpeeds targets;
    int32_t yaw_integral_q8;  ///< angle units/s
    int16_t yaw_error;        ///< with a lag, angle units/s
  };

  void forget_yaw();
  int32_t corrected_yaw_rate(const MotionCommand& command, int32_t measured_rate);

  State state_{};
  Kept<Parameters> parameters_;
  TrackSpeedControl left_;
  TrackSpeedControl right_;
};

}  // namespace screed
