// The robot: the whole firmware core as one object. Samples in, outputs out, nothing else.
//
// A Robot holds all state of the control program. It makes no HAL call, keeps no static, allocates
// nothing and does no floating point, so a recorded run replays to the bit, a test needs no fake,
// and many robots fit in one process.
#pragma once

#include "firmware/control/drive_control.h"
#include "firmware/estimation/attitude.h"
#include "firmware/estimation/odometry.h"
#include "firmware/leveling/leveling.h"
#include "firmware/robot/board_constants.h"
#include "firmware/robot/parameters.h"
#include "firmware/robot/supervisor.h"
#include "firmware/telemetry/telemetry.h"
#include "hal/sample.h"

namespace screed {

class Robot {
 public:
  /// `parameters_intact` = false: the parameters stand in for lost ones; the robot refuses to be
  /// armed.
  Robot(const BoardConstants& board, const Parameters& parameters, bool parameters_intact = true);

  /// One control tick. The sample's encoder counts may start anywhere; the first tick takes them as
  /// zero.
  void tick(const SensorSample& sample, RobotOutput& output);

  // What the robot thinks, for recording and tests.
  const AttitudeEstimator& attitude() const { return attitude_; }
  const Odometry& odometry() const { return odometry_; }
  const Supervisor& supervisor() const { return supervisor_; }
  const Leveling& leveling() const { return leveling_; }
  const DriveControl& drive() const { return drive_; }
  const MotionCommand& motion() const { return motion_; }

 private:
  struct Deltas {
    int16_t left;
    int16_t right;
  };

  // Asked for once a tick: on the AVR an angle costs 1500 cycles, a position a division.
  struct Pose {
    Angle roll;
    Angle pitch;
    Angle heading;
    int32_t x_mm;
    int32_t y_mm;
  };

  Deltas count_deltas(const SensorSample& sample);
  void estimate_pose(const SensorSample& sample, const Deltas& deltas);
  void receive(const SensorSample& sample);
  void handle(const CanFrame& frame);
  RequestResult command(const CanFrame& frame);
  void supervise(const SensorSample& sample, const Deltas& deltas);
  void choose_motion();
  void report(const SensorSample& sample, RobotOutput& output);

  uint16_t battery_uv_per_lsb_;
  AttitudeEstimator attitude_;
  Odometry odometry_;
  Supervisor supervisor_;
  Leveling leveling_;
  DriveControl drive_;
  SlcanParser parser_;
  Telemetry telemetry_;
  Pose pose_ = {0, 0, 0, 0, 0};
  MotionCommand motion_ = {0, 0};         ///< what the body is to do now
  MotionCommand drive_command_ = {0, 0};  ///< last CommandOp::kDrive
  uint16_t battery_mv_ = 0;
  uint16_t last_left_ = 0;
  uint16_t last_right_ = 0;
  int16_t duty_left_ = 0;
  int16_t duty_right_ = 0;
  uint8_t rejected_frames_ = 0;
  uint8_t ground_counter_ = 0xFF;  ///< alive counter of the last ground heartbeat; 0xFF: none yet
  uint8_t command_counter_ = 0xFF;
  bool first_tick_ = true;
  bool was_running_ = false;
};

}  // namespace screed
