// How a robot takes the counts of its IMU: calibrated, and only new ones.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "tests/unit/test_robot.h"

namespace screed {
namespace {

TEST(RobotImu, OffsetsOfTheImuAreTakenOffBeforeTheEstimate) {
  Parameters parameters;
  parameters.accel_offset_x() = 300;
  parameters.accel_offset_y() = -200;
  parameters.accel_offset_z() = 100;
  parameters.mag_offset_x() = 4150;
  parameters.mag_offset_y() = -4120;
  parameters.mag_offset_z() = 90;
  parameters.gyro_offset_x() = 25;
  parameters.gyro_offset_y() = -20;
  parameters.gyro_offset_z() = 15;
  TestRobot plain;
  TestRobot shifted(parameters);
  for (TestRobot* robot : {&plain, &shifted}) {
    robot->sample.imu.accel()[0] = 500;
    robot->sample.imu.accel()[1] = 400;
    robot->sample.imu.mag()[0] = 300;
  }
  for (int i = 0; i < 3; ++i) {
    const int16_t accel[] = {300, -200, 100};
    const int16_t mag[] = {4150, -4120, 90};
    const int16_t gyro[] = {25, -20, 15};
    shifted.sample.imu.accel()[i] = static_cast<int16_t>(shifted.sample.imu.accel()[i] + accel[i]);
    shifted.sample.imu.mag()[i] = static_cast<int16_t>(shifted.sample.imu.mag()[i] + mag[i]);
    shifted.sample.imu.gyro()[i] = static_cast<int16_t>(shifted.sample.imu.gyro()[i] + gyro[i]);
  }
  // The gyro's first axis has a last digit that moves: the same one in both.
  for (int tick = 0; tick < 800; ++tick) {
    plain.sample.imu.gyro()[0] = static_cast<int16_t>(tick % 2);
    plain.sample.imu.gyro()[1] = static_cast<int16_t>(tick % 5);
    plain.sample.imu.gyro()[2] = static_cast<int16_t>(tick % 3);
    for (int i = 0; i < 3; ++i) {
      const int16_t gyro[] = {25, -20, 15};
      shifted.sample.imu.gyro()[i] = static_cast<int16_t>(plain.sample.imu.gyro()[i] + gyro[i]);
    }
    for (TestRobot* robot : {&plain, &shifted}) {
      robot->sample.fresh = kFreshGyro | kFreshAccel | kFreshMag;
      robot->sample.time_us += kTickPeriod_us;
      robot->robot.tick(robot->sample, robot->output);
    }
    const AttitudeAngles a = plain.robot.attitude().angles();
    const AttitudeAngles b = shifted.robot.attitude().angles();
    ASSERT_EQ(a.roll, b.roll) << tick;
    ASSERT_EQ(a.pitch, b.pitch) << tick;
    ASSERT_EQ(a.heading, b.heading) << tick;
  }
  EXPECT_GT(std::abs(plain.robot.attitude().angles().pitch), 500);
}

TEST(RobotImu, ACountThatTheOffsetWouldWrapStaysAsItIs) {
  Parameters parameters;
  parameters.accel_offset_x() = 1000;
  TestRobot corrected(parameters);
  TestRobot plain;
  for (TestRobot* robot : {&corrected, &plain}) {
    robot->sample.imu.accel()[0] = INT16_MIN + 10;  // less 1000 would be a large positive number
    robot->run(300);
  }
  EXPECT_EQ(corrected.robot.attitude().angles().pitch, plain.robot.attitude().angles().pitch);
}

TEST(RobotImu, OnlyANewMagnetometersSampleTurnsTheHeading) {
  TestRobot robot;
  robot.run(700);
  ASSERT_TRUE(robot.robot.attitude().ready());
  const Angle before = robot.robot.attitude().angles().heading;
  robot.sample.imu.mag()[0] = 1217;  // a quarter turn
  robot.sample.imu.mag()[1] = 0;
  for (int tick = 0; tick < 1000; ++tick) {
    robot.sample.time_us += kTickPeriod_us;
    robot.sample.fresh = kFreshGyro | kFreshAccel;
    robot.sample.imu.gyro()[0] = robot.sample.imu.gyro()[0] == 0 ? 1 : 0;
    robot.sample.radio_in_count = 0;
    robot.robot.tick(robot.sample, robot.output);
  }
  const auto turned = static_cast<Angle>(robot.robot.attitude().angles().heading - before);
  EXPECT_LT(std::abs(turned), 300);
  robot.run(2000);
  const auto now = static_cast<Angle>(robot.robot.attitude().angles().heading - before);
  EXPECT_GT(std::abs(now), 3000) << "it is believed again";
}

TEST(RobotImu, ARollOrPitchThatTheGyroFollowsIsSeenWhileItGoesOn) {
  // Faster than what the accelerometer is a witness in: the estimator alone tells.
  for (const int axis : {0, 1}) {
    TestRobot robot;
    robot.run(600);
    robot.send(robot.command(CommandOp::kArm));
    robot.run(4);
    ASSERT_EQ(robot.state(), RobotState::kArmed);
    constexpr double kRate_deg_per_s = 70.0;
    double angle = 0.0;
    while (angle < 90.0 && robot.state() == RobotState::kArmed) {
      angle += kRate_deg_per_s * 0.01;
      const double radians = angle * 3.14159265358979 / 180.0;
      robot.sample.time_us += kTickPeriod_us;
      robot.sample.radio_in_count = 0;
      const int noise = ++robot.ticks % 2;  // else it is a frozen gyro
      robot.sample.imu.gyro()[axis] = static_cast<int16_t>(kRate_deg_per_s / 0.07 + noise);
      robot.sample.imu.accel()[axis == 0 ? 1 : 0] =
          static_cast<int16_t>((axis == 0 ? 1.0 : -1.0) * 4098.0 * std::sin(radians));
      robot.sample.imu.accel()[2] = static_cast<int16_t>(4098.0 * std::cos(radians));
      robot.robot.tick(robot.sample, robot.output);
    }
    EXPECT_EQ(robot.robot.supervisor().faults(), Fault::kTilt) << axis;
    EXPECT_LT(angle, 70.0) << axis;
    EXPECT_GT(angle, 40.0) << axis;
  }
}

TEST(RobotImu, ARateThatStaysIsBiasOnlyWhileBothTracksRest) {
  // 7 counts are 0.49 degrees/s; which of the tracks moves does not matter.
  const auto turned = [](int left, int right) {
    TestRobot robot;
    robot.run(700);
    const Angle before = robot.robot.attitude().angles().heading;
    for (int tick = 0; tick < 2000; ++tick) {
      robot.sample.time_us += kTickPeriod_us;
      robot.sample.fresh = kFreshGyro | kFreshAccel;
      robot.sample.imu.gyro()[0] = robot.sample.imu.gyro()[0] == 0 ? 1 : 0;
      robot.sample.imu.gyro()[2] = 7;
      robot.sample.radio_in_count = 0;
      if (tick % 2 == 0) {
        robot.sample.encoder_left = static_cast<uint16_t>(robot.sample.encoder_left + left);
        robot.sample.encoder_right = static_cast<uint16_t>(robot.sample.encoder_right + right);
      }
      robot.robot.tick(robot.sample, robot.output);
    }
    const auto change = static_cast<Angle>(robot.robot.attitude().angles().heading - before);
    return change * 360.0 / 65536.0;
  };
  EXPECT_LT(std::abs(turned(0, 0)), 5.0);
  EXPECT_GT(turned(1, 0), 8.0);
  EXPECT_GT(turned(0, 1), 8.0);
  EXPECT_GT(turned(1, 1), 8.0);
}

}  // namespace
}  // namespace screed
