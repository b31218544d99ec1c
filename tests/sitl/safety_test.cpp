// Closed loop: what stops the robot, and how fast.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "host_sim/core/constants.h"
#include "tests/sitl/test_drive.h"

namespace screed::testing {
namespace {

TEST(Safety, ARobotLaidOnItsSideIsReportedAndStopped) {
  TestDrive drive(HeightField::flat(20.0, 0.1), drive_options(0.15, 0.0));
  ASSERT_TRUE(drive.start());
  drive.run(3.0);
  ASSERT_GT(drive.output.duty_left, 0);
  drive.world.plant().robot(0).lay_on_side();
  const uint64_t begin = drive.world.ticks();
  ASSERT_TRUE(drive.run_until(
      1.0, [&] { return drive.output.duty_left == 0 && drive.output.duty_right == 0; }));
  EXPECT_LE(drive.world.ticks() - begin, 10u);  // 100 ms
  EXPECT_EQ(drive.robot.supervisor().state(), RobotState::kFault);
  EXPECT_EQ(drive.robot.supervisor().faults(), Fault::kTilt);
  // Reported: the ground station knows within two heartbeats.
  drive.run(0.5);
  EXPECT_EQ(drive.world.ground_station().report().state, RobotState::kFault);
  EXPECT_EQ(drive.world.ground_station().report().faults, Fault::kTilt);
  // Latched: it stays so.
  drive.run(5.0);
  EXPECT_EQ(drive.output.duty_left, 0);
  EXPECT_EQ(drive.robot.supervisor().state(), RobotState::kFault);
}

TEST(Safety, ARobotThatStartsOnItsSideIsNotArmed) {
  WorldOptions options = drive_options(0.1, 0.0);
  options.starts[0].attitude.roll = 1.5707963;
  options.starts[0].z_m = 0.12;
  TestDrive drive(HeightField::flat(20.0, 0.1), options);
  drive.run(10.0);
  EXPECT_EQ(drive.robot.supervisor().state(), RobotState::kDisarmed);
  EXPECT_EQ(drive.output.duty_left, 0);
}

TEST(Safety, ALostLinkStopsThenDisarms) {
  WorldOptions options = drive_options(0.1, 0.0);
  TestDrive drive(HeightField::flat(20.0, 0.1), options);
  ASSERT_TRUE(drive.start());
  drive.run(2.0);
  // The ground falls silent: nothing of what arrives reaches the robot any more.
  drive.tamper = [](SensorSample& sample) { sample.radio_in_count = 0; };
  int stopped_after = 0;
  while (drive.robot.supervisor().running() && stopped_after < 300) {
    drive.tick();
    ++stopped_after;
  }
  EXPECT_LE(stopped_after, 55);
  EXPECT_GE(stopped_after, 30);  // heartbeats come every 0.2 s
  int disarmed_after = stopped_after;
  while (drive.robot.supervisor().state() != RobotState::kDisarmed && disarmed_after < 600) {
    drive.tick();
    ++disarmed_after;
  }
  EXPECT_LE(disarmed_after, 155);
  EXPECT_LT(std::abs(drive.forward_speed()), 0.005);
}

TEST(Safety, ATrackThatCannotMoveLosesPower) {
  TestDrive drive(HeightField::flat(20.0, 0.1), drive_options(0.15, 0.0));
  ASSERT_TRUE(drive.start());
  drive.run(2.0);
  // The left encoder stands still from now on.
  const uint16_t stuck = drive.world.sample().encoder_left;
  drive.tamper = [stuck](SensorSample& sample) { sample.encoder_left = stuck; };
  int ticks = 0;
  while (drive.robot.supervisor().faults() == 0 && ticks < 200) {
    drive.tick();
    ++ticks;
  }
  EXPECT_EQ(drive.robot.supervisor().faults(), Fault::kStallLeft);
  EXPECT_EQ(drive.output.duty_left, 0);
  EXPECT_EQ(drive.output.duty_right, 0);
}

TEST(Safety, HalfOfAllPacketsLostIsNoReasonToDriveOn) {
  WorldOptions options = drive_options(0.1, 0.0);
  options.radio.loss = 0.5;
  TestDrive drive(HeightField::flat(20.0, 0.1), options);
  drive.run(60.0);
  // Whatever happened on the way, the robot never drives without a live link.
  for (int i = 0; i < 3000; ++i) {
    drive.tick();
    if (drive.robot.supervisor().running()) {
      ASSERT_TRUE(drive.robot.supervisor().link_alive());
    }
  }
}

// Steel beside the site: the heading follows the gyroscope, and the robot drives on.
TEST(Safety, AMagneticDisturbanceIsFlaggedAndTheHeadingHolds) {
  TestDrive drive(HeightField::flat(8.0, 0.1), drive_options(0.1, 0.0));
  ASSERT_TRUE(drive.start());
  drive.run(5.0);
  ASSERT_FALSE(drive.robot.attitude().mag_disturbed());
  const auto heading_error_deg = [&] {
    const double believed = drive.robot.attitude().heading() * std::numbers::pi / 32768.0;
    return kDegPerRad *
           std::abs(std::remainder(believed - drive.attitude().heading, 2.0 * std::numbers::pi));
  };
  const double before = heading_error_deg();

  drive.tamper = [](SensorSample& sample) {  // half of the site's field, across the robot
    sample.imu.mag()[1] = static_cast<int16_t>(sample.imu.mag()[1] + 1600);
  };
  for (int second = 0; second < 12; ++second) {
    drive.run(1.0);
    EXPECT_TRUE(drive.robot.attitude().mag_disturbed()) << second;
    EXPECT_NEAR(heading_error_deg(), before, 1.0) << second;
  }
  EXPECT_TRUE(drive.robot.supervisor().running());
  EXPECT_GT(drive.forward_speed(), 0.08);

  drive.tamper = nullptr;
  drive.run(1.0);
  EXPECT_FALSE(drive.robot.attitude().mag_disturbed());
  EXPECT_NEAR(heading_error_deg(), before, 1.0);
}

}  // namespace
}  // namespace screed::testing
