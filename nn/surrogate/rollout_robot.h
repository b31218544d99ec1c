// What of a recorded robot a surrogate of its motion does not stand in for: its firmware and its
// sensors.
#pragma once

#include <array>

#include "firmware/robot/robot.h"
#include "host_sim/devices/sensors/imu_model.h"
#include "host_sim/physics/world/environment.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/session/session_layout.h"

namespace screed::nn {

class RolloutRobot {
 public:
  /// As it is switched on, before the session's first row.
  RolloutRobot(const SessionInfo& info, const Experiment& experiment);

  /// Goes on by a row of the recording: the firmware receives the sample it received then, and the
  /// sensors' noise advances as it did.
  void follow(const SensorSample& recorded);
  /// A tick on its own: the sensors measure the robot. Of the recorded sample time and radio
  /// remain.
  void tick(const RobotView& robot, const SensorSample& recorded);

  /// The sample of such a tick: of the recorded one time and radio remain.
  SensorSample measure(const RobotView& robot, const SensorSample& recorded);

  /// The last answer of the firmware: what the motors receive of the battery voltage, -1..1.
  std::array<double, 2> duty_ratio() const;
  double counts_per_turn() const { return counts_per_turn_; }

 private:
  Robot firmware_;
  RobotOutput output_{};
  ImuModel imu_;
  double counts_per_turn_;
  double volt_per_lsb_;
};

}  // namespace screed::nn
