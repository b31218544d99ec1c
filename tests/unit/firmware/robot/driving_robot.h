// A robot that drives on a command, for tests of the whole firmware.
#pragma once

#include <gtest/gtest.h>

#include "tests/unit/test_robot.h"

namespace screed {

inline Parameters drive_parameters() {
  Parameters parameters;
  parameters.algorithm() = static_cast<int16_t>(LevelingAlgorithm::kDrive);
  return parameters;
}

/// A robot that drives straight on at a speed, in mm/s.
inline TestRobot driving_robot(int16_t speed) {
  TestRobot robot(drive_parameters());
  robot.start();
  robot.send(robot.command(CommandOp::kDrive, {speed, 0}));
  robot.run(200);
  EXPECT_EQ(robot.state(), RobotState::kRunning);
  EXPECT_NEAR(robot.left.speed_mm_per_s, speed, 10.0);
  EXPECT_NEAR(robot.right.speed_mm_per_s, speed, 10.0);
  return robot;
}

}  // namespace screed
