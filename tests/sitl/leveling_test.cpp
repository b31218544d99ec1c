// Closed loop: the leveling algorithms find hills, and stay on their site.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/sitl/test_drive.h"

namespace screed::testing {
namespace {

// A hill of 0.25 m in the middle of the site; its flank is 19 degrees at most.
HeightField hill() {
  return HeightField::from_function(121, 121, 0.05, false, [](double x, double y) {
    return 0.25 * std::exp(-(x * x + y * y) / (2.0 * 0.45 * 0.45));
  });
}

Parameters leveling_parameters(LevelingAlgorithm algorithm) {
  Parameters parameters;
  parameters.algorithm() = static_cast<int16_t>(algorithm);
  return parameters;
}

WorldOptions facing_the_hill() {
  WorldOptions options;
  options.starts[0].x_m = -1.5;
  return options;
}

TEST(Leveling, HillSensingChargesTheHill) {
  Parameters parameters = leveling_parameters(LevelingAlgorithm::kHillSensing);
  parameters.site_radius() = 2500;
  TestDrive drive(hill(), facing_the_hill(), parameters);
  ASSERT_TRUE(drive.run_until(
      180.0, [&] { return drive.robot.leveling().state() == LevelingState::kClimb; }));
  EXPECT_GT(drive.attitude().pitch, 0.05);  // it really points up
  EXPECT_EQ(drive.robot.motion().speed_mm_per_s, parameters.climb_speed());
  EXPECT_EQ(drive.robot.motion().yaw_rate, 0);
}

TEST(Leveling, SpinOnPeakSpinsNearTheTop) {
  Parameters parameters = leveling_parameters(LevelingAlgorithm::kSpinOnPeak);
  parameters.walk_yaw_rate_max() = 5;  // nearly straight at the hill
  TestDrive drive(hill(), facing_the_hill(), parameters);
  ASSERT_TRUE(drive.run_until(
      120.0, [&] { return drive.robot.leveling().state() == LevelingState::kSpin; }));
  const double height_of_begin =
      drive.world.terrain().at(drive.position().x(), drive.position().y()).height;
  const double at_begin = drive.attitude().heading;
  EXPECT_GT(height_of_begin, 0.15);
  // 90 degrees/s for 4 s is a whole turn.
  double turned = 0.0;
  double last = at_begin;
  while (drive.robot.leveling().state() == LevelingState::kSpin) {
    drive.tick();
    turned += std::remainder(drive.attitude().heading - last, 2.0 * M_PI);
    last = drive.attitude().heading;
  }
  EXPECT_NEAR(std::abs(turned), 2.0 * M_PI, 0.6);
}

TEST(Leveling, TheFenceKeepsTheRobotOnItsSite) {
  Parameters parameters = leveling_parameters(LevelingAlgorithm::kHillSensing);
  parameters.site_radius() = 1000;
  parameters.walk_yaw_rate_max() = 10;
  TestDrive drive(HeightField::flat(20.0, 0.1), WorldOptions{}, parameters);
  double farthest = 0.0;
  bool returned = false;
  for (int i = 0; i < 300 * kTickRate_hz; ++i) {
    drive.tick();
    farthest = std::max(farthest, drive.position().head<2>().norm());
    returned = returned || drive.robot.leveling().state() == LevelingState::kReturn;
  }
  EXPECT_TRUE(returned);
  EXPECT_GT(farthest, 0.7);   // turns back the earlier the less it knows where it is
  EXPECT_LT(farthest, 1.15);  // braking, and dead reckoning that is some centimetres off
}

}  // namespace
}  // namespace screed::testing
