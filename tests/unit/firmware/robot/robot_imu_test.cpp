// How a robot takes the counts of its IMU: calibrated, and only new ones.
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/unit/test_robot.h"

namespace screed {
namespace {

TEST(RobotImu, OffsetsOfTheImuAreTakenOffBeforeTheEstimate) {
  Parameters parameters;
  parameters.accel_offset_x = 300;
  parameters.accel_offset_y = -200;
  parameters.accel_offset_z = 100;
  parameters.mag_offset_x = 150;
  parameters.mag_offset_y = -120;
  parameters.mag_offset_z = 90;
  parameters.gyro_offset_x = 25;
  parameters.gyro_offset_y = -20;
  parameters.gyro_offset_z = 15;
  TestRobot plain;
  TestRobot shifted(parameters);
  for (TestRobot* robot : {&plain, &shifted}) {
    robot->sample.accel[0] = 500;
    robot->sample.accel[1] = 400;
    robot->sample.mag[0] = 300;
  }
  for (int i = 0; i < 3; ++i) {
    const int16_t accel[] = {300, -200, 100};
    const int16_t mag[] = {150, -120, 90};
    const int16_t gyro[] = {25, -20, 15};
    shifted.sample.accel[i] = static_cast<int16_t>(shifted.sample.accel[i] + accel[i]);
    shifted.sample.mag[i] = static_cast<int16_t>(shifted.sample.mag[i] + mag[i]);
    shifted.sample.gyro[i] = static_cast<int16_t>(shifted.sample.gyro[i] + gyro[i]);
  }
  // The gyro's first axis has a last digit that moves: the same one in both.
  for (int tick = 0; tick < 800; ++tick) {
    plain.sample.gyro[0] = static_cast<int16_t>(tick % 2);
    plain.sample.gyro[1] = static_cast<int16_t>(tick % 5);
    plain.sample.gyro[2] = static_cast<int16_t>(tick % 3);
    for (int i = 0; i < 3; ++i) {
      const int16_t gyro[] = {25, -20, 15};
      shifted.sample.gyro[i] = static_cast<int16_t>(plain.sample.gyro[i] + gyro[i]);
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
  parameters.accel_offset_x = 1000;
  TestRobot corrected(parameters);
  TestRobot plain;
  for (TestRobot* robot : {&corrected, &plain}) {
    robot->sample.accel[0] = INT16_MIN + 10;  // less 1000 would be a large positive number
    robot->run(300);
  }
  EXPECT_EQ(corrected.robot.attitude().angles().pitch, plain.robot.attitude().angles().pitch);
}

TEST(RobotImu, OnlyANewMagnetometersSampleTurnsTheHeading) {
  TestRobot robot;
  robot.run(700);
  ASSERT_TRUE(robot.robot.attitude().ready());
  const Angle before = robot.robot.attitude().angles().heading;
  robot.sample.mag[0] = 1217;  // a quarter turn
  robot.sample.mag[1] = 0;
  for (int tick = 0; tick < 1000; ++tick) {
    robot.sample.time_us += kTickPeriod_us;
    robot.sample.fresh = kFreshGyro | kFreshAccel;
    robot.sample.gyro[0] = robot.sample.gyro[0] == 0 ? 1 : 0;
    robot.sample.radio_in_count = 0;
    robot.robot.tick(robot.sample, robot.output);
  }
  const auto turned = static_cast<Angle>(robot.robot.attitude().angles().heading - before);
  EXPECT_LT(std::abs(turned), 300);
  robot.run(2000);
  const auto now = static_cast<Angle>(robot.robot.attitude().angles().heading - before);
  EXPECT_GT(std::abs(now), 3000) << "it is believed again";
}

}  // namespace
}  // namespace screed
