// Errors along a recorded path, against closed formulas.
#include "nn/surrogate/rollout_checker.h"

#include <gtest/gtest.h>

#include "tests/unit/nn/surrogate/made_up_drive.h"

namespace screed::nn {
namespace {

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
