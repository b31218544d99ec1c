// The robot with its real firmware on beds of particles.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/sitl/test_drive.h"

namespace screed::testing {
namespace {

HeightField level_bed() {
  return HeightField::from_function(9, 9, 1.0 / 8.0, false, [](double, double) { return 0.1; });
}

WorldOptions on_particles(double speed_m_per_s, double yaw_rate_deg_per_s, bool tracks) {
  WorldOptions options = drive_options(speed_m_per_s, yaw_rate_deg_per_s);
  options.vehicle.tracks = tracks;
  options.starts[0].x_m = -0.2;
  options.particles.emplace();
  return options;
}

class ParticleDrive : public ::testing::TestWithParam<bool> {};

// It stands still until it is told to go, goes ahead with some slip, and stays on its tracks.
TEST_P(ParticleDrive, StandsAndDrives) {
  TestDrive drive(level_bed(), on_particles(0.1, 0.0, GetParam()));
  const Eigen::Vector3d begin = drive.position();
  ASSERT_TRUE(drive.start());
  EXPECT_LT((drive.position() - begin).head<2>().norm(), 0.005);
  EXPECT_LT(drive.world.plant().terrain_work().awake, 20U);
  drive.run(4.0);
  const double distance = (drive.position() - begin).head<2>().norm();
  EXPECT_GT(distance, 0.2);
  EXPECT_LT(distance, 0.42);
  const Attitude attitude = drive.attitude();
  EXPECT_LT(std::abs(attitude.roll), 0.35);
  EXPECT_LT(std::abs(attitude.pitch), 0.35);
  // The bed supports it: its weight lies between floor and surface.
  EXPECT_GT(drive.position().z(), 0.08);
  EXPECT_EQ(drive.robot.supervisor().faults(), 0);
}

INSTANTIATE_TEST_SUITE_P(Gear, ParticleDrive, ::testing::Bool(),
                         [](const auto& gear) { return gear.param ? "Tracks" : "Wheels"; });

// At rest the ground supports the robot's weight; the bed around it sleeps.
TEST(ParticleDriveTest, ARobotAtRestCostsNothing) {
  WorldOptions options = on_particles(0.1, 0.0, true);
  options.ground_station_arms = false;
  TestDrive drive(level_bed(), options);
  drive.run(2.0);
  const uint64_t work = drive.world.plant().terrain_work().element_steps;
  const Eigen::Vector3d begin = drive.position();
  drive.run(2.0);
  EXPECT_EQ(drive.world.plant().terrain_work().element_steps, work);
  EXPECT_LT((drive.position() - begin).norm(), 1e-5);
}

TEST(ParticleDriveTest, SameSeedSameBits) {
  const auto end = [] {
    TestDrive drive(level_bed(), on_particles(0.15, 40.0, true));
    drive.start();
    drive.run(2.0);
    return drive.position();
  };
  EXPECT_EQ(end(), end());
}

}  // namespace
}  // namespace screed::testing
