// Closed loop on rigid ground: the commanded motion is reached and held, on the level and on
// slopes.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/sitl/test_drive.h"

namespace screed::testing {
namespace {

constexpr double kDeg = std::numbers::pi / 180.0;

struct Order {
  double speed_m_per_s;
  double yaw_rate_deg_per_s;
};

class Driving : public ::testing::TestWithParam<Order> {};

// Every second mean of the last eight of ten seconds is within 5 % of what was commanded.
TEST_P(Driving, ReachesAndHoldsTheCommandedMotion) {
  const Order order = GetParam();
  TestDrive drive(HeightField::flat(20.0, 0.1),
                  drive_options(order.speed_m_per_s, order.yaw_rate_deg_per_s));
  ASSERT_TRUE(drive.start());
  drive.run(2.0);
  for (int second = 0; second < 8; ++second) {
    double speed = 0.0;
    double rate = 0.0;
    for (int i = 0; i < kTickRate_hz; ++i) {
      drive.tick();
      speed += drive.forward_speed() / kTickRate_hz;
      rate += drive.yaw_rate() / kTickRate_hz;
    }
    // What is commanded to be zero stays within 5 % of the other figure's scale.
    EXPECT_NEAR(speed, order.speed_m_per_s, 0.05 * std::max(std::abs(order.speed_m_per_s), 0.1))
        << "second " << second;
    EXPECT_NEAR(rate / kDeg, order.yaw_rate_deg_per_s,
                0.05 * std::max(std::abs(order.yaw_rate_deg_per_s), 45.0))
        << "second " << second;
  }
}

INSTANTIATE_TEST_SUITE_P(Orders, Driving,
                         ::testing::Values(Order{0.1, 0.0}, Order{-0.1, 0.0}, Order{0.0, 45.0},
                                           Order{0.0, -45.0}, Order{0.1, 45.0}, Order{0.1, -45.0},
                                           Order{-0.1, 45.0}, Order{0.2, 10.0}));

TEST(DrivingOnSlopes, ClimbsTwentyDegrees) {
  WorldOptions options = drive_options(0.1, 0.0);
  options.starts[0].x_m = -4.0;
  TestDrive drive(HeightField::ramp(10.0, 0.1, 20.0), options);
  ASSERT_TRUE(drive.start());
  const Eigen::Vector3d begin = drive.position();
  drive.run(20.0);
  const Eigen::Vector3d displacement = drive.position() - begin;
  // 0.1 m/s along the slope, less the start.
  EXPECT_NEAR(displacement.norm(), 2.0, 0.1);
  EXPECT_NEAR(displacement.z(), displacement.norm() * std::sin(20.0 * kDeg), 0.01);
  EXPECT_NEAR(displacement.y(), 0.0, 0.05);
  EXPECT_EQ(drive.robot.supervisor().faults(), 0);
}

TEST(DrivingOnSlopes, StandsStillOnASlopeWhenStopped) {
  WorldOptions options;
  options.ground_station_arms = false;
  TestDrive drive(HeightField::ramp(10.0, 0.1, 20.0), options);
  drive.run(0.5);
  const Eigen::Vector3d begin = drive.position();
  drive.run(10.0);
  // Stuck, not creeping: the bristles hold.
  EXPECT_LT((drive.position() - begin).norm(), 1e-4);
}

TEST(Estimation, FollowsTheTruthWhileDrivingOverASlope) {
  WorldOptions options = drive_options(0.1, 20.0);
  TestDrive drive(HeightField::ramp(10.0, 0.1, 15.0), options);
  ASSERT_TRUE(drive.start());
  double worst = 0.0;
  for (int i = 0; i < 20 * kTickRate_hz; ++i) {
    drive.tick();
    const double pitch = drive.robot.attitude().pitch() * std::numbers::pi / 32768.0;
    const double roll = drive.robot.attitude().roll() * std::numbers::pi / 32768.0;
    worst = std::max(
        {worst, std::abs(pitch - drive.attitude().pitch), std::abs(roll - drive.attitude().roll)});
  }
  EXPECT_LT(worst, 1.5 * kDeg);  // accelerometer bias of 8 mg is 0.46 degrees, three sigma
}

TEST(Estimation, DeadReckoningStaysNearTheTruth) {
  TestDrive drive(HeightField::flat(20.0, 0.1), drive_options(0.15, 15.0));
  ASSERT_TRUE(drive.start());
  drive.run(60.0);
  const Eigen::Vector3d truth = drive.position();
  const double x = drive.robot.position().mm(kX) * 1e-3;
  const double y = drive.robot.position().mm(kY) * 1e-3;
  // 9 m of path: a heading error of a few degrees (hard iron left over) and track slip.
  EXPECT_LT(std::hypot(x - truth.x(), y - truth.y()), 0.3);
}

}  // namespace
}  // namespace screed::testing
