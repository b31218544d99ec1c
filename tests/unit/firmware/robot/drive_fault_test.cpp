// Faults of motors and encoders, with the whole robot in the loop: how long it takes until the
// motors have no power. docs/mcu-simulation.md lists them.
#include <gtest/gtest.h>

#include <initializer_list>

#include "tests/unit/firmware/robot/driving_robot.h"

namespace screed {
namespace {

int ms_until_fault(TestRobot& robot) {
  int ticks = 0;
  for (; robot.state() != RobotState::kFault && ticks < 500; ++ticks) robot.tick();
  return 10 * ticks;
}

constexpr int16_t kSpeeds[] = {60, 100, 150, 200, 250, -60, -200};

// 22
TEST(DriveFaults, AnEncoderThatCountsTheWrongWayStopsTheRobot) {
  for (const int16_t speed : kSpeeds) {
    TestRobot robot = driving_robot(speed);
    robot.left_encoder_sign = -1;
    EXPECT_LE(ms_until_fault(robot), 280) << speed;
    EXPECT_EQ(robot.robot.supervisor().faults(), Fault::kMotorLeft) << speed;
    EXPECT_EQ(robot.output.duty_left, 0);
    EXPECT_EQ(robot.output.duty_right, 0);
  }
  // From the start on.
  TestRobot robot(drive_parameters());
  robot.left_encoder_sign = -1;
  robot.start();
  robot.send(robot.command(CommandOp::kDrive, {200, 0}));
  EXPECT_LE(ms_until_fault(robot), 350);
  EXPECT_LT(std::abs(robot.left.travel_mm), 40.0);
}

// 25
TEST(DriveFaults, ADriverThatIsStuckIsAFault) {
  for (const int16_t duty : std::initializer_list<int16_t>{400, -400, 200, -200}) {
    // Nobody asked for motion.
    TestRobot robot = driving_robot(0);
    robot.left_driver_stuck_at = duty;
    EXPECT_LE(ms_until_fault(robot), 350) << duty;
    EXPECT_EQ(robot.robot.supervisor().faults(), Fault::kMotorLeft) << duty;
    // The motors are to stop, or to turn the other way.
    for (const int16_t to : std::initializer_list<int16_t>{0, -150, -250}) {
      const int sign = duty > 0 ? 1 : -1;
      TestRobot moving = driving_robot(static_cast<int16_t>(150 * sign));
      moving.left_driver_stuck_at = duty;
      moving.send(moving.command(CommandOp::kDrive, {static_cast<int16_t>(to * sign), 0}));
      EXPECT_LE(ms_until_fault(moving), 900) << duty << " to " << to;
      EXPECT_NE(moving.robot.supervisor().faults() & Fault::kMotorLeft, 0) << duty << " to " << to;
    }
  }
}

// 24 and 21: 300 and 200 ms
TEST(DriveFaults, AStalledTrackAndADeadEncoderAreFoundAtLowSpeed) {
  for (const int16_t speed : kSpeeds) {
    TestRobot stalled = driving_robot(speed);
    stalled.left_blocked = true;
    stalled.left.speed_mm_per_s = 0.0;
    EXPECT_LE(ms_until_fault(stalled), 200) << speed;
    EXPECT_EQ(stalled.robot.supervisor().faults(), Fault::kStallLeft) << speed;
    TestRobot dead = driving_robot(speed);
    dead.right_encoder_dead = true;
    EXPECT_LE(ms_until_fault(dead), 200) << speed;
    EXPECT_EQ(dead.robot.supervisor().faults(), Fault::kStallRight) << speed;
  }
}

// Motors reverse, stop and start with a delay; that is no fault.
TEST(DriveFaults, AWellRobotMayReverseAsItLikes) {
  for (const int16_t accel_limit : std::initializer_list<int16_t>{50, 600, 2000, 5000}) {
    Parameters parameters = drive_parameters();
    parameters.accel_limit() = accel_limit;
    TestRobot robot(parameters);
    robot.start();
    for (const int16_t speed :
         std::initializer_list<int16_t>{250, -250, 0, 250, 0, -250, 250, 20, -20, 250, 60, 0}) {
      robot.send(robot.command(CommandOp::kDrive, {speed, 0}));
      robot.run(accel_limit < 600 ? 1100 : 150);
      ASSERT_EQ(robot.state(), RobotState::kRunning) << accel_limit << " to " << speed;
    }
    robot.send(robot.command(CommandOp::kDrive, {250, 0}));
    robot.run(200);
    robot.send(robot.command(CommandOp::kStop));
    robot.run(100);
    EXPECT_EQ(robot.state(), RobotState::kStopped);
  }
}

}  // namespace
}  // namespace screed
