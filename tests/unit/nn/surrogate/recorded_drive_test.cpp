// What a recording says of its robot, on made-up drives.
#include "nn/surrogate/recorded_drive.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/unit/nn/surrogate/made_up_drive.h"

namespace screed::nn {
namespace {

/// Read from a folder that is gone afterwards.
RecordedDrive recorded(const MadeUpDrive& drive) {
  const TempFolder folder;
  record(folder.path() / "run", drive);
  return RecordedDrive(folder.path() / "run");
}

void expect_refused(const MadeUpDrive& drive, const std::string& why) {
  const TempFolder folder;
  record(folder.path() / "run", drive);
  const std::string message =
      message_of<InputError>([&] { const RecordedDrive refused(folder.path() / "run"); });
  EXPECT_EQ(message.find((folder.path() / "run").string()), 0U) << message;
  EXPECT_NE(message.find(why), std::string::npos) << message;
}

TEST(RolloutRecording, HasTheRowsOfTheSessionAndTheSoilOfTheExperiment) {
  MadeUpDrive drive;
  drive.experiment = "[map]\nmodel = scm\n[soil]\npreset = soft\n[sensors]\ncalibrated = false\n";
  drive.frames = 40;
  drive.alter = [](std::size_t row, SimFrame& frame, SensorSample& sample) {
    frame.battery = 7.0 + 0.001 * static_cast<double>(row);
    sample.encoder_left = static_cast<std::uint16_t>(3 * row);
  };
  const RecordedDrive read = recorded(drive);
  EXPECT_EQ(read.first, 5U);
  EXPECT_FALSE(read.experiment.sensors.calibrated);
  EXPECT_EQ(read.soil.k_phi, soil_preset("soft").k_phi);
  EXPECT_EQ(read.soil.exponent, soil_preset("soft").exponent);
  ASSERT_EQ(read.frames.size(), 45U);
  ASSERT_EQ(read.samples.size(), 45U);
  EXPECT_EQ(read.frames[44].battery, 7.044);
  EXPECT_EQ(read.samples[44].encoder_left, 132);
}

TEST(RolloutRecording, ThePathIsTheSumOfTheDisplacementsFromTheFirstPlaceOn) {
  MadeUpDrive drive;
  drive.x = 3.0;
  drive.y = -2.0;
  drive.heading_rad = 0.4;
  drive.turn_rad = 0.002;
  drive.before = 0;
  drive.frames = 500;
  const RecordedDrive read = recorded(drive);
  EXPECT_EQ(read.first, 0U);
  ASSERT_EQ(read.poses.size(), 500U);
  for (const std::size_t row : {0U, 1U, 17U, 499U}) {
    // Chords of a circle.
    const double frames = static_cast<double>(row) + 1.0;
    const double way = 0.005 * std::sin(frames * 0.001) / std::sin(0.001);
    const double towards = 0.4 + frames * 0.001;
    EXPECT_NEAR(read.poses[row].x_m, 3.0 + way * std::cos(towards), 1e-12) << row;
    EXPECT_NEAR(read.poses[row].y_m, -2.0 + way * std::sin(towards), 1e-12) << row;
    EXPECT_NEAR(read.poses[row].heading_rad, 0.4 + frames * 0.002, 1e-12) << row;
    EXPECT_NEAR(read.distances[row], frames * 0.005, 1e-12) << row;
    EXPECT_NEAR(read.motions[row].forward_m, 0.005, 1e-15) << row;
    EXPECT_NEAR(read.motions[row].sideways_m, 0.0, 1e-15) << row;
    EXPECT_EQ(read.motions[row].turn_rad, 0.002) << row;
  }
}

TEST(RolloutRecording, SideslipIsADisplacementToTheLeft) {
  MadeUpDrive drive;
  drive.heading_rad = 2.1;
  drive.frames = 20;
  drive.before = 2;
  drive.alter = [](std::size_t row, SimFrame& frame, SensorSample&) {
    if (row < 2) return;
    frame.delta_x = 0.004 * std::cos(2.1) - 0.003 * std::sin(2.1);
    frame.delta_y = 0.004 * std::sin(2.1) + 0.003 * std::cos(2.1);
  };
  const RecordedDrive read = recorded(drive);
  EXPECT_NEAR(read.motions[10].forward_m, 0.004, 1e-15);
  EXPECT_NEAR(read.motions[10].sideways_m, 0.003, 1e-15);
  EXPECT_EQ(read.distances[1], 0.0) << "at rest";
  EXPECT_NEAR(read.distances[11], 10 * 0.005, 1e-12);
  EXPECT_NEAR(read.poses[11].x_m, 10 * (0.004 * std::cos(2.1) - 0.003 * std::sin(2.1)), 1e-12);
}

TEST(RolloutRecording, ARolloutEndsBehindTheRowThatHasTheDistance) {
  MadeUpDrive drive;
  drive.distance_m = kExact_m;
  drive.frames = 400;
  const RecordedDrive read = recorded(drive);
  constexpr std::uint64_t kMany = 40000;
  EXPECT_EQ(read.end_of_rollout(100, 1.0, kMany), 100U + 128U + 1U);
  EXPECT_EQ(read.end_of_rollout(0, 1.0, kMany), 4U + 128U + 1U) << "five frames at rest";
  EXPECT_EQ(read.end_of_rollout(100, 2.0, kMany), 100U + 256U + 1U);
  EXPECT_EQ(read.end_of_rollout(100, 1.0, 128), 100U + 128U + 1U);
  EXPECT_EQ(read.end_of_rollout(100, 1.0, 127), 100U + 127U + 1U) << "no more frames";
  EXPECT_EQ(read.end_of_rollout(100, 1.0, 0), 101U);
  EXPECT_EQ(read.end_of_rollout(100, 10.0, kMany), 405U) << "the recording is over";
  EXPECT_EQ(read.end_of_rollout(404, 10.0, kMany), 405U);
}

TEST(RolloutRecording, TheStateIsThatAtTheRowsEnd) {
  MadeUpDrive drive;
  drive.frames = 40;
  drive.alter = [](std::size_t row, SimFrame& frame, SensorSample& sample) {
    const auto at = static_cast<double>(row);
    frame.delta_x = 0.001 * at;
    frame.delta_theta = row == 20 ? 0.01 : 0.0;
    frame.track_left = 0.01 * at;
    frame.track_right = -0.02 * at;
    frame.battery = 7.0 + 0.01 * at;
    frame.energy = 3.0 * at;
    sample.encoder_left = static_cast<std::uint16_t>(10 * row);
    sample.encoder_right = static_cast<std::uint16_t>(65535 - row);
  };
  const DrivingState state = recorded(drive).state(20, 400.0);
  EXPECT_NEAR(state.pose.x_m, 0.21, 1e-6);
  EXPECT_NEAR(state.pose.heading_rad, 0.01, 1e-15);
  EXPECT_NEAR(state.last.forward_m, 0.02, 1e-6);
  EXPECT_NEAR(state.last.turn_rad, 0.01, 1e-15);
  EXPECT_EQ(state.track_speed_m_per_s[0], 0.01 * 20.0);
  EXPECT_EQ(state.track_speed_m_per_s[1], -0.02 * 20.0);
  constexpr double kTurn = 2.0 * std::numbers::pi;
  EXPECT_NEAR(state.shaft_angle_rad[0], 200.5 / 400.0 * kTurn, 1e-12);
  EXPECT_NEAR(state.shaft_angle_rad[1], 65515.5 / 400.0 * kTurn, 1e-9);
  EXPECT_EQ(state.battery.terminal_v, 7.2);
  EXPECT_EQ(state.battery.energy_j, 60.0);
  double drawn_c = 0.0;
  for (int row = 1; row <= 20; ++row) drawn_c += 3.0 / (7.0 + 0.01 * row);
  EXPECT_NEAR(state.battery.drawn_c, drawn_c, 1e-9);
}

TEST(RolloutRecording, NeedsSoilHeightsAndFourFramesOfAlgorithm5) {
  MadeUpDrive drive;
  drive.frames = 4;
  EXPECT_NO_THROW(recorded(drive));
  drive.frames = 3;
  expect_refused(drive, "drove no frame");
  drive.frames = 30;
  drive.alter = [](std::size_t, SimFrame& frame, SensorSample&) { frame.leveling_state = 0; };
  expect_refused(drive, "drove no frame");
  drive.alter = {};
  drive.heights = false;
  expect_refused(drive, "session on soil");
  drive.heights = true;
  drive.experiment = "[map]\nmodel = rigid\n";
  expect_refused(drive, "session on soil");
}

}  // namespace
}  // namespace screed::nn
