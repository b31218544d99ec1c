// The image that is flashed, in lockstep with the world: it drives, and what it shows is what it
// read and did.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "firmware/robot/robot.h"
#include "host_sim/core/errors.h"
#include "host_sim/devices/sensors/imu_model.h"
#include "host_sim/run/experiment/board_table.h"
#include "host_sim/run/simulation/parity.h"
#include "host_sim/run/world/image_robot.h"
#include "tests/mcu/image_drive.h"

namespace screed::mcu {
namespace {

double forward_speed(ImageDrive& drive) {
  const ChassisState chassis = drive.body().vehicle().chassis();
  return chassis.pose.linear().col(0).dot(chassis.velocity);
}

/// Against a host's robot with these parameters.
ParityResult parity(ImageDrive& drive, const Parameters& parameters, double seconds) {
  RobotSettings host = drive.world.robot().settings();
  host.parameters = parameters;
  return run_parity(drive.world, host, seconds, [](const ParityResult&) { return true; });
}

TEST(CoSimulation, TheImageDrivesAtTheSpeedItIsTold) {
  ImageDrive drive;
  drive.set_off();
  const double begin_x = drive.body().vehicle().chassis().pose.translation().x();
  drive.run(5.0);
  const double displacement = drive.body().vehicle().chassis().pose.translation().x() - begin_x;
  EXPECT_NEAR(displacement, 5.0 * ImageDrive::kSpeed_m_per_s, 0.05);
  EXPECT_NEAR(forward_speed(drive), ImageDrive::kSpeed_m_per_s, 0.02);
  drive.expect_punctual();
  const CycleReport cycles = drive.cycles();
  EXPECT_EQ(cycles.encoder_missing, 0);
  EXPECT_GT(cycles.encoder_edges, 2000U);
  EXPECT_EQ(cycles.uart_overruns, 0U);
}

TEST(CoSimulation, HostAndImageGiveTheSameBytes) {
  ImageDrive drive;
  Parameters parameters;
  parameters.algorithm() = static_cast<int16_t>(LevelingAlgorithm::kDrive);
  const ParityResult result = parity(drive, parameters, 15.0);
  EXPECT_EQ(result.differing_bytes, 0U) << result.first_difference;
  EXPECT_GT(result.ticks, 1490U);
  EXPECT_GT(result.driving_ticks, 500U);
}

TEST(CoSimulation, TheImageOfAnotherNodeIsThatRobotToTheByte) {
  CommandKey key = test_key();
  key.robot_id = kOtherNode;
  ImageDrive drive(kOtherNodeImage, key);
  Parameters parameters;
  parameters.algorithm() = static_cast<int16_t>(LevelingAlgorithm::kDrive);
  const ParityResult result = parity(drive, parameters, 12.0);
  EXPECT_EQ(result.differing_bytes, 0U) << result.first_difference;
  EXPECT_GT(result.driving_ticks, 300U) << "it took the commands of its ground station";
  EXPECT_FALSE(drive.last_frame(id_of_node(kIdAttitude, kOtherNode)).empty());
  EXPECT_TRUE(drive.last_frame(kIdAttitude).empty());
}

TEST(CoSimulation, ParityFindsADifference) {
  ImageDrive drive;
  Parameters parameters;
  parameters.algorithm() = static_cast<int16_t>(LevelingAlgorithm::kDrive);
  parameters.speed_kp() = 25;  // the image has 24
  const ParityResult result = parity(drive, parameters, 10.0);
  EXPECT_GT(result.differing_bytes, 0U);
  ASSERT_TRUE(result.first_difference_tick.has_value());
  EXPECT_GT(*result.first_difference_tick, 500U) << "while the robot stands, kp means nothing";
  EXPECT_NE(result.first_difference.find("duty"), std::string::npos) << result.first_difference;
}

TEST(CoSimulation, WhatTheProgramShowsIsWhatItsPinsDo) {
  ImageDrive drive;
  drive.set_off();
  for (int i = 0; i < 100; ++i) {
    drive.tick();
    const Board& board = drive.board();
    EXPECT_EQ(std::lround(board.motor_duty_ratio(kLeft) * kDutyMax), drive.output.duty_left);
    EXPECT_EQ(std::lround(board.motor_duty_ratio(kRight) * kDutyMax), drive.output.duty_right);
    EXPECT_EQ(board.leds(), drive.output.leds);
  }
}

TEST(CoSimulation, SensorsSayWhatTheWorldIs) {
  ImageDrive drive;
  drive.run(2.0);
  EXPECT_NEAR(drive.sample.imu.accel()[2] * 0.244e-3, 1.0, 0.05);
  EXPECT_NEAR(drive.sample.imu.mag()[1] * 0.160e-3, ImuModel::earth_field_gauss().y(), 0.05);
  EXPECT_NEAR(drive.sample.pressure / 4096.0, 1013.25, 1.0);
  EXPECT_NEAR(drive.sample.temperature / 480.0 + 42.5, ImuModel::kTemperature_degc, 0.01);
  const double volt =
      drive.sample.battery * board_constants_of(kDefaultBoard).battery_uv_per_lsb * 1e-6;
  EXPECT_NEAR(volt, drive.body().battery().terminal_v, 0.02);
}

TEST(CoSimulation, AHandledRobotFeelsWhatAPersonDoes) {
  ImageDrive drive(1, 0.0, true);
  const int ticks = static_cast<int>(0.5 * kCalibrationMotionPeriod_s * kTickRate_hz);
  int compared = 0;
  for (int i = 0; i < ticks; ++i) {
    drive.tick();
    const ImuTruth now = calibration_motion(1e-3 * drive.time_ms());
    // The chips are configured, and the robot is held still.
    if (i < 100 || now.mean_rate_rad_per_s.norm() > 0.01) continue;
    const Eigen::Vector3d felt(drive.sample.imu.accel()[0], drive.sample.imu.accel()[1],
                               drive.sample.imu.accel()[2]);
    ASSERT_LT((felt * 0.244e-3 - now.mean_specific_force / 9.80665).norm(), 0.06) << i;
    ++compared;
  }
  EXPECT_GT(compared, 1000);
}

TEST(CoSimulation, TheSameSeedGivesTheSameBytesAlsoBesideAnotherWorld) {
  ImageDrive alone(1);
  std::vector<RobotOutput> outputs;
  std::vector<SensorSample> samples;
  for (int i = 0; i < 900; ++i) {
    alone.tick();
    outputs.push_back(alone.output);
    samples.push_back(alone.sample);
  }
  ImageDrive again(1);
  ImageDrive other(2);
  bool others_differ = false;
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    again.tick();
    other.tick();
    ASSERT_EQ(
        std::memcmp(again.sample.imu.gyro(), samples[i].imu.gyro(), sizeof samples[i].imu.gyro()),
        0)
        << i;
    ASSERT_EQ(again.sample.encoder_left, samples[i].encoder_left) << i;
    ASSERT_EQ(again.output.duty_left, outputs[i].duty_left) << i;
    ASSERT_EQ(again.output.radio_out_count, outputs[i].radio_out_count) << i;
    others_differ = others_differ || other.sample.imu.gyro()[0] != samples[i].imu.gyro()[0];
  }
  EXPECT_TRUE(others_differ);
  EXPECT_EQ(again.log.str(), alone.log.str());
}

TEST(CoSimulation, AnUndeclaredRegisterEndsTheRunWithItsName) {
  ImageDrive drive;
  drive.run(0.2);
  Lsm303d& chip = drive.board().accel_mag;
  chip.select(Lsm303d::kAddress, false);
  chip.write(0x55);
  chip.write(0x12);
  try {
    drive.run(0.1);
    FAIL() << "the run went on";
  } catch (const RunError& error) {
    EXPECT_STREQ(error.what(),
                 "LSM303D: the program writes register 0x55 (value 0x12), which the model does not "
                 "declare");
  }
}

TEST(CoSimulation, RefusesWhatIsNoImage) {
  RobotOptions robot;
  robot.image = RobotImage{"/no/such/screed.elf", kDefaultBoard};
  EXPECT_THROW(check_image(robot), InputError);
  EXPECT_THROW(Mcu{kScreedListing}, InputError);
}

}  // namespace
}  // namespace screed::mcu
