// What a recording says of its robot, on made-up drives.
#include "nn/surrogate/rollout.h"

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

// ---- Errors along a recorded path, against closed formulas

double deviation_of(const std::vector<double>& values) {
  StandardDeviation deviation;
  for (const double value : values) deviation.add(value);
  return deviation.deviation();
}

TEST(RolloutDeviation, IsThatOfTheWholePopulation) {
  EXPECT_EQ(deviation_of({}), 0.0);
  EXPECT_EQ(deviation_of({-3.0}), 0.0);
  EXPECT_EQ(deviation_of({1.0, 3.0}), 1.0);
  EXPECT_EQ(deviation_of({2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0}), 2.0);
}

TEST(RolloutDeviation, OfOneNumberManyTimesIsNoRootOfLessThanNothing) {
  for (int tenths = 1; tenths < 50; ++tenths) {
    for (std::size_t count = 1; count < 20; ++count) {
      EXPECT_NEAR(deviation_of(std::vector<double>(count, 0.1 * tenths)), 0.0, 1e-6);
    }
  }
}

/// Follows a made-up drive from a row on, with the recorded poses changed by this.
Rollout follow(const MadeUpDrive& drive, std::uint64_t start,
               const std::function<void(std::uint64_t row, PlanarPose&)>& change = {}) {
  const TempFolder folder;
  record(folder.path() / "run", drive);
  const RecordedDrive recording(folder.path() / "run");
  RolloutChecker checker(recording, start);
  for (std::uint64_t row = start + 1; row < recording.frames.size(); ++row) {
    PlanarPose pose = recording.poses[row];
    if (change) change(row, pose);
    checker.add_row(row, pose);
  }
  return checker.take();
}

MadeUpDrive exact(std::size_t frames) {
  MadeUpDrive drive;
  drive.distance_m = kExact_m;
  drive.frames = frames;
  drive.x = -0.5;
  drive.y = 2.0;
  return drive;
}

constexpr std::uint64_t kStart = 17;

TEST(RolloutChecks, TheErrorsAreThoseOfTheRowThatHasTheDistance) {
  const auto change = [](std::uint64_t row, PlanarPose& pose) {
    if (row != kStart + 128 && row != kStart + 640) return;
    pose.x_m += 0.03;
    pose.y_m -= 0.04;
    pose.heading_rad -= 0.1;
  };
  MadeUpDrive drive = exact(1500);
  const Rollout result = follow(drive, kStart, change);
  EXPECT_EQ(result.start, kStart);
  for (const RolloutCheck& check : result.checks) {
    EXPECT_TRUE(check.reached);
    EXPECT_TRUE(check.straight);
  }
  EXPECT_NEAR(result.checks[0].position_error, 0.05, 1e-12);
  EXPECT_NEAR(result.checks[1].position_error, 0.01, 1e-12);
  EXPECT_NEAR(result.checks[2].position_error, 0.0, 1e-12);
  EXPECT_NEAR(result.checks[0].heading_error_rad, 0.1, 1e-12);
  EXPECT_NEAR(result.checks[1].heading_error_rad, 0.1, 1e-12);
  EXPECT_NEAR(result.checks[2].heading_error_rad, 0.0, 1e-12);

  drive.heading_rad = 1.5;
  EXPECT_NEAR(follow(drive, kStart, change).checks[0].heading_error_rad, 0.1, 1e-12);
  EXPECT_NEAR(follow(drive, kStart, change).checks[2].heading_error_rad, 0.0, 1e-12);
}

TEST(RolloutChecks, AreReachedWithTheFrameThatMakesTheDistance) {
  // Five frames at rest; the start is row 17.
  EXPECT_TRUE(follow(exact(13 + 128), kStart).checks[0].reached);
  EXPECT_FALSE(follow(exact(12 + 128), kStart).checks[0].reached);
  EXPECT_TRUE(follow(exact(13 + 640), kStart).checks[1].reached);
  EXPECT_FALSE(follow(exact(12 + 640), kStart).checks[1].reached);
  EXPECT_TRUE(follow(exact(13 + 1280), kStart).checks[2].reached);
  EXPECT_FALSE(follow(exact(12 + 1280), kStart).checks[2].reached);
}

TEST(RolloutChecks, AFrameMayMakeMoreThanOneDistance) {
  MadeUpDrive drive = exact(40);
  drive.alter = [](std::size_t row, SimFrame& frame, SensorSample&) {
    if (row == 30) frame.delta_x = 20.0;
  };
  for (const RolloutCheck& check : follow(drive, kStart).checks) EXPECT_TRUE(check.reached);
}

TEST(RolloutChecks, ATurnIsNoLongerStraightFromTheFrameOnThatItIsWantedIn) {
  MadeUpDrive drive = exact(1500);
  drive.alter = [](std::size_t row, SimFrame& frame, SensorSample&) {
    frame.angular = row == kStart || row == kStart + 200 ? -0.3 : 0.0;
  };
  const Rollout result = follow(drive, kStart);
  EXPECT_TRUE(result.checks[0].straight);
  EXPECT_FALSE(result.checks[1].straight);
  EXPECT_FALSE(result.checks[2].straight);
}

TEST(RolloutChecks, EveryTenthPoseIsThePath) {
  const Rollout result = follow(exact(60), kStart);
  ASSERT_EQ(result.path.size(), 4U) << "rows 27, 37, 47 and 57 of 65";
  for (std::size_t i = 0; i < result.path.size(); ++i) {
    // Row r has made r - 4 frames of the drive.
    EXPECT_NEAR(result.path[i].x_m, -0.5 + (23.0 + 10.0 * static_cast<double>(i)) * kExact_m,
                1e-12);
    EXPECT_EQ(result.path[i].y_m, 2.0);
  }
}

TEST(RolloutChecks, RatesOfTurnDeviateAsTheirFramesDo) {
  MadeUpDrive drive = exact(101 + 12);
  drive.heading_rad = 0.7;
  drive.alter = [](std::size_t row, SimFrame& frame, SensorSample&) {
    frame.delta_theta = row <= kStart ? 0.0 : (row % 2 == 0 ? 0.02 : -0.02);
  };
  const Rollout result = follow(drive, kStart, [](std::uint64_t row, PlanarPose& pose) {
    pose.heading_rad = 0.7 + (row % 2 == 0 ? 0.01 : 0.0);
  });
  EXPECT_NEAR(result.yaw_rate_deviation_rad_per_s, 1.0, 1e-9) << "from 0.7 to 0.71 and back";
  EXPECT_NEAR(result.recorded_yaw_rate_deviation_rad_per_s, 2.0, 1e-9);
}

TEST(RolloutChecks, AnEvenTurnDoesNotDeviateFromItself) {
  MadeUpDrive drive = exact(300);
  drive.turn_rad = 0.003;
  const Rollout result = follow(drive, kStart);
  EXPECT_NEAR(result.yaw_rate_deviation_rad_per_s, 0.0, 1e-6);
  EXPECT_NEAR(result.recorded_yaw_rate_deviation_rad_per_s, 0.0, 1e-6);
}

}  // namespace
}  // namespace screed::nn
