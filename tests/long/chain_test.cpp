// The robot on tracks of links.
// Long: a chain of thirty links has many contacts, and must drive until a fault in it would show.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "host_sim/core/constants.h"
#include "host_sim/core/errors.h"
#include "tests/sitl/test_drive.h"
#include "tests/step_one.h"

namespace screed::testing {
namespace {

constexpr double kDeg = std::numbers::pi / 180.0;

WorldOptions chains(double speed_m_per_s = 0.0, double yaw_rate_deg_per_s = 0.0) {
  WorldOptions options = drive_options(speed_m_per_s, yaw_rate_deg_per_s);
  options.vehicle.track_model = TrackModel::kChain;
  return options;
}

HeightField level() {
  return HeightField::flat(20.0, 0.1);
}

// Hills of 2 cm with bumps of 6 mm, as long as two links and more.
HeightField rough(double spacing_m) {
  const int nodes = static_cast<int>(std::lround(2.5 / spacing_m));
  return HeightField::from_function(nodes, nodes, spacing_m, true, [](double x, double y) {
    constexpr double kTurn = 2.0 * std::numbers::pi / 2.5;
    return 0.02 * std::sin(2.0 * kTurn * x) * std::cos(2.0 * kTurn * y) +
           0.006 * std::sin(40.0 * kTurn * x) * std::cos(20.0 * kTurn * y);
  });
}

/// What must hold of a chain all the time.
struct Worst {
  double from_loop_m = 0.0;
  double longest = 0.0;  // of the unloaded length
  double shortest = 2.0;
  double fastest_m_per_s = 0.0;  // of the chassis, up or down
};

void run(Plant& plant, double seconds, double left, double right, Worst& worst) {
  const int64_t steps = std::lround(seconds / plant.step_s());
  for (int64_t i = 0; i < steps; ++i) {
    testing::step_one(plant, {left, right});
    for (const Side side : {kLeft, kRight}) {
      const ChainTrack& chain = *plant.robot(0).vehicle().chain(side);
      const double length = chain.length_m() / chain.unloaded_length_m();
      // fmax and fmin pass a NaN over; the sum does not.
      ASSERT_TRUE(std::isfinite(length + chain.farthest_from_loop_m()));
      worst.from_loop_m = std::max(worst.from_loop_m, chain.farthest_from_loop_m());
      worst.longest = std::max(worst.longest, length);
      worst.shortest = std::min(worst.shortest, length);
    }
    worst.fastest_m_per_s =
        std::max(worst.fastest_m_per_s, std::abs(plant.robot(0).vehicle().chassis().velocity.z()));
  }
}

void expect_whole(const Worst& worst, double most_from_loop_m) {
  EXPECT_LT(worst.from_loop_m, most_from_loop_m);
  EXPECT_LT(worst.longest, 1.01);
  EXPECT_GT(worst.shortest, 0.99);
}

TEST(ChainTrack, HangsOnItsWheelsWithItsTension) {
  Plant plant(level(), rover5(), chains());
  const ChainTrack& chain = *plant.robot(0).vehicle().chain(kLeft);
  EXPECT_EQ(chain.pins(), 56u);
  // 10 N stretch it by a thousandth; the weight on it changes that little.
  EXPECT_NEAR(chain.length_m() / chain.unloaded_length_m(), 1.001, 0.0002);
  EXPECT_LT(chain.farthest_from_loop_m(), 0.0015);
}

TEST(ChainTrack, StaysAtRest) {
  for (const double slope_deg : {0.0, 20.0}) {
    WorldOptions options = chains();
    options.starts[0].attitude.pitch = slope_deg * kDeg;
    Plant plant(HeightField::ramp(10.0, 0.1, slope_deg), rover5(), options);
    const Eigen::Vector3d begin = plant.robot(0).vehicle().chassis().pose.translation();
    Worst worst;
    run(plant, 20.0, 0.0, 0.0, worst);
    const ChassisState end = plant.robot(0).vehicle().chassis();
    EXPECT_LT((end.pose.translation() - begin).norm(), 1e-6) << slope_deg;
    EXPECT_LT(end.velocity.norm() + end.omega_body.norm(), 1e-9) << slope_deg;
  }
}

// A minute each, on level ground.
TEST(ChainTrack, DrivesAtTheSpeedOfItsSprockets) {
  Plant plant(level(), rover5(), chains());
  Worst worst;
  run(plant, 1.0, 0.5, 0.5, worst);
  const double begin = plant.robot(0).vehicle().chassis().pose.translation().x();
  const double angle = plant.robot(0).vehicle().shaft_angle_rad(kLeft);
  run(plant, 60.0, 0.5, 0.5, worst);
  const double rolled = (plant.robot(0).vehicle().shaft_angle_rad(kLeft) - angle) * 0.03;
  EXPECT_GT(rolled, 5.0);
  EXPECT_NEAR(plant.robot(0).vehicle().chassis().pose.translation().x() - begin, rolled,
              0.05 * rolled);
  EXPECT_NEAR(plant.robot(0).vehicle().chassis().pose.translation().y(), 0.0, 0.05);
  expect_whole(worst, 0.002);
  EXPECT_LT(worst.fastest_m_per_s, 0.03);
}

TEST(ChainTrack, TurnsInPlace) {
  Plant plant(level(), rover5(), chains());
  Worst worst;
  run(plant, 60.0, -0.6, 0.6, worst);
  EXPECT_LT(plant.robot(0).vehicle().chassis().pose.translation().head<2>().norm(), 0.1);
  EXPECT_GT(plant.robot(0).vehicle().chassis().omega_body.z(), 0.5);
  expect_whole(worst, 0.002);
}

TEST(ChainTrack, CrossesRoughGround) {
  Plant plant(rough(0.0125), rover5(), chains());
  Worst worst;
  run(plant, 60.0, 0.8, 0.7, worst);
  EXPECT_GT(plant.robot(0).vehicle().shaft_angle_rad(kLeft) * 0.03, 10.0);
  expect_whole(worst, 0.01);
}

TEST(ChainTrack, SurvivesAFallAndSpinsUpsideDown) {
  WorldOptions options = chains();
  options.starts[0].z_m = 0.4;
  Plant fall(level(), rover5(), options);
  Worst worst;
  run(fall, 3.0, 0.0, 0.0, worst);
  expect_whole(worst, 0.02);
  EXPECT_LT(fall.robot(0).vehicle().chassis().velocity.norm(), 1e-6);

  options.starts[0].attitude.roll = std::numbers::pi;
  Plant roof(level(), rover5(), options);
  run(roof, 5.0, 0.5, 0.5, worst);
  expect_whole(worst, 0.02);
  EXPECT_LT(roof.robot(0).vehicle().chassis().pose.translation().head<2>().norm(), 0.1);
}

TEST(ChainTrack, ClimbsTwentyDegrees) {
  WorldOptions options = chains(0.1, 0.0);
  options.starts[0].x_m = -4.0;
  TestDrive drive(HeightField::ramp(10.0, 0.1, 20.0), options);
  ASSERT_TRUE(drive.start());
  const Eigen::Vector3d begin = drive.position();
  drive.run(20.0);
  EXPECT_NEAR((drive.position() - begin).norm(), 2.0, 0.1);
  EXPECT_EQ(drive.robot.supervisor().faults(), 0);
}

// The heading at the start is free: the chain is made in the frame of its side.
TEST(ChainTrack, TheStartHeadingDoesNotMatter) {
  const auto displacement = [](double heading_deg) {
    WorldOptions options = chains();
    options.starts[0].attitude.heading = heading_deg * kDeg;
    Plant plant(level(), rover5(), options);
    Worst worst;
    run(plant, 5.0, 0.6, 0.5, worst);
    return plant.robot(0).vehicle().chassis().pose.translation().head<2>().norm();
  };
  EXPECT_NEAR(displacement(57.0), displacement(0.0), 1e-3);
}

// Lighter wheels carry it, the robot's mass is the same; in the air nothing pushes it sideways.
TEST(ChainTrack, KeepsMassAndMomentum) {
  WorldOptions options = chains();
  options.starts[0].z_m = 20.0;
  Plant plant(level(), rover5(), options);
  OdeWorld belt_world;
  const Vehicle belt(belt_world, rover5(), VehicleOptions{});
  EXPECT_NEAR(plant.robot(0).vehicle().mass_kg(), belt.mass_kg(), 1e-12);
  Worst worst;
  run(plant, 1.0, 1.0, -1.0, worst);
  const ChassisState state = plant.robot(0).vehicle().chassis();
  EXPECT_NEAR(state.velocity.z(), -kGravity_m_per_s2, 0.005);
  EXPECT_LT(state.velocity.head<2>().norm(), 0.005);
  expect_whole(worst, 0.002);
}

TEST(ChainTrack, TheFirmwareDrivesItOnSoil) {
  for (const char* soil : {"viper", "lete_sand"}) {
    SCOPED_TRACE(soil);
    WorldOptions options = chains(0.1, 0.0);
    options.soil = soil_preset(soil);
    options.starts[0].x_m = -0.7;
    TestDrive drive(HeightField::flat(2.0, 0.005), options);
    ASSERT_TRUE(drive.start());
    const Eigen::Vector3d begin = drive.position();
    drive.run(8.0);
    EXPECT_NEAR((drive.position() - begin).norm(), 0.8, 0.05);
    EXPECT_EQ(drive.world.plant().volume_balance().error(), 0);
    EXPECT_EQ(drive.robot.supervisor().faults(), 0);
  }
}

TEST(ChainTrack, CrossesRoughSoil) {
  WorldOptions options = chains();
  options.soil = soil_preset("viper");
  Plant plant(rough(0.01), rover5(), options);
  Worst worst;
  run(plant, 20.0, 0.8, 0.7, worst);
  expect_whole(worst, 0.01);
  EXPECT_EQ(plant.volume_balance().error(), 0);
}

// Where Sandbox' tracks came off: gravel, straight on, turning and back.
TEST(ChainTrack, StaysOnItsWheelsOnGravel) {
  WorldOptions options = chains();
  options.particles = ParticleOptions{};
  options.starts[0].x_m = -0.2;
  Plant plant(
      HeightField::from_function(
          121, 121, 0.01, false,
          [](double x, double y) { return 0.1 + 0.02 * std::sin(9.0 * x) * std::cos(7.0 * y); }),
      rover5(), options);
  Worst worst;
  run(plant, 2.0, 0.7, 0.7, worst);
  EXPECT_GT(plant.robot(0).vehicle().chassis().pose.translation().x(), 0.0);
  for (const double spin : {0.8, -0.8}) run(plant, 6.0, -spin, spin, worst);
  run(plant, 2.0, -0.7, -0.7, worst);
  expect_whole(worst, 0.02);
  EXPECT_LT(worst.fastest_m_per_s, 0.5);
}

TEST(ChainTrack, RefusesWhatGivesNoChain) {
  WorldOptions few = chains();
  few.vehicle.chain.links = 5;
  EXPECT_THROW(Plant(level(), rover5(), few), InputError);
  WorldOptions heavy = chains();
  heavy.vehicle.chain.mass_kg = 0.2;
  EXPECT_THROW(Plant(level(), rover5(), heavy), InputError);
  WorldOptions slow = chains();
  slow.physics_step_s = 0.002;
  EXPECT_THROW(Plant(level(), rover5(), slow), InputError);
}

}  // namespace
}  // namespace screed::testing
