// The vehicle's physics against closed formulas.
#include <gtest/gtest.h>

#include <cmath>
#include <future>
#include <numbers>
#include <vector>

#include "host_sim/core/constants.h"
#include "host_sim/physics/terrain/rigid_terrain.h"
#include "tests/sitl/test_drive.h"

namespace screed::testing {
namespace {

constexpr double kDeg = std::numbers::pi / 180.0;
constexpr double kStep_s = 0.001;

struct Bench {
  explicit Bench(HeightField field, const VehicleOptions& options = {})
      : ground(std::move(field)), vehicle(ode, rover5(), options) {}

  void put_down(double x, double y, const Attitude& attitude = {0, 0, 0}) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = rotation_from(attitude);
    pose.translation() << x, y, vehicle.resting_height(ground.surface(), x, y, pose.linear());
    vehicle.place(pose);
  }
  void run(double seconds, double left_v = 0.0, double right_v = 0.0) {
    const int64_t steps = std::lround(seconds / kStep_s);
    for (int64_t i = 0; i < steps; ++i) {
      vehicle.apply_forces(ground, {left_v, right_v}, kStep_s);
      ode.step(kStep_s);
    }
  }

  RigidTerrain ground;
  OdeWorld ode;
  Vehicle vehicle;
};

TEST(VehiclePhysics, WorldsOfSeveralThreadsStepAtTheSameTime) {
  const auto drive = [] {
    Bench bench(HeightField::flat(10.0, 0.1));
    bench.put_down(0.0, 0.0);
    bench.run(2.0, 5.0, 4.0);
    return Eigen::Vector3d(bench.vehicle.chassis().pose.translation());
  };
  const Eigen::Vector3d alone = drive();
  std::vector<std::future<Eigen::Vector3d>> worlds;
  worlds.reserve(4);
  for (int i = 0; i < 4; ++i) worlds.push_back(std::async(std::launch::async, drive));
  for (auto& world : worlds) EXPECT_EQ(world.get(), alone);
}

TEST(VehiclePhysics, FallsFreely) {
  Bench bench(HeightField::flat(10.0, 0.1));
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation().z() = 100.0;
  bench.vehicle.place(pose);
  bench.run(2.0);
  EXPECT_NEAR(100.0 - bench.vehicle.chassis().pose.translation().z(), 0.5 * kGravity_m_per_s2 * 4.0,
              0.02);
  EXPECT_NEAR(bench.vehicle.chassis().velocity.z(), -2.0 * kGravity_m_per_s2, 1e-6);
}

TEST(VehiclePhysics, SinksInByTheSpringsOfItsTracks) {
  Bench bench(HeightField::flat(10.0, 0.1));
  bench.put_down(0, 0);
  const double begin = bench.vehicle.chassis().pose.translation().z();
  bench.run(2.0);
  // 0.4 mm under its own load, a little more towards the heavier end.
  EXPECT_NEAR(begin - bench.vehicle.chassis().pose.translation().z(), 0.0004, 0.0001);
  EXPECT_LT(bench.vehicle.chassis().velocity.norm(), 1e-6);
}

TEST(VehiclePhysics, UnloadedTrackReachesTheNoLoadSpeed) {
  const GearMotor motor;
  Bench bench(HeightField::flat(10.0, 0.1));
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation().z() = 1000.0;  // in the air
  bench.vehicle.place(pose);
  bench.run(1.0, 7.2, -7.2);
  const double omega = (7.2 - motor.no_load_current_a * motor.resistance_ohm) / motor.back_emf_v_s;
  EXPECT_NEAR(bench.vehicle.track_speed_m_per_s(kLeft), omega * 0.03, 1e-4);
  EXPECT_NEAR(bench.vehicle.track_speed_m_per_s(kRight), -omega * 0.03, 1e-4);
  EXPECT_NEAR(bench.vehicle.track_speed_m_per_s(kLeft), 0.25, 0.005);  // the data sheet's 25 cm/s
  EXPECT_NEAR(bench.vehicle.current_a(kLeft), motor.no_load_current_a, 1e-4);
}

TEST(VehiclePhysics, StallTorqueIsTheDataSheets) {
  const GearMotor motor;
  const double stall = motor.torque_per_ampere() * motor.current(7.2, 0.0);
  EXPECT_NEAR(motor.current(7.2, 0.0), 2.5, 1e-9);
  EXPECT_NEAR(stall, 10.0 * 0.0980665, 0.01);  // 10 kg cm
}

// With its brakes on and little friction the robot slides: a = g (sin - mu cos).
TEST(VehiclePhysics, SlidesDownASlopeAsCoulombSays) {
  VehicleOptions options;
  options.track_friction = 0.2;
  Bench bench(HeightField::ramp(40.0, 0.5, 20.0), options);
  bench.put_down(10.0, 0.0, {0.0, 20.0 * kDeg, 0.0});
  bench.run(1.0);
  const double begin = bench.vehicle.chassis().velocity.norm();
  bench.run(1.0);
  const double acceleration =
      kGravity_m_per_s2 * (std::sin(20.0 * kDeg) - 0.2 * std::cos(20.0 * kDeg));
  EXPECT_NEAR(bench.vehicle.chassis().velocity.norm() - begin, acceleration, 0.01 * acceleration);
}

// Spinning in place: the share of the tracks' speed that turns the robot follows from the moment
// balance of Coulomb friction under an evenly loaded footprint of length L and tread B. With slip
// speed w a along the track, the integral over the footprint of (a B/2 - x^2) / sqrt(a^2 + x^2)
// vanishes; a is found by bisection.
TEST(VehiclePhysics, SkidTurnFollowsTheMomentBalance) {
  Bench bench(HeightField::flat(10.0, 0.1));
  bench.put_down(0, 0);
  bench.run(1.0);
  bench.run(3.0, -4.0, 4.0);
  double angle = 0.0;
  double distance = 0.0;
  for (int i = 0; i < 3000; ++i) {
    bench.run(kStep_s, -4.0, 4.0);
    angle += bench.vehicle.chassis().omega_body.z() * kStep_s;
    distance += bench.vehicle.track_speed_m_per_s(kRight) * kStep_s;
  }
  const double half_tread = bench.vehicle.tread_m() / 2.0;
  const double half_length = 0.185 / 2.0;
  double low = 1e-4;
  double high = 0.1;
  for (int i = 0; i < 60; ++i) {
    const double a = 0.5 * (low + high);
    double moment = 0.0;
    constexpr int kSteps = 2000;
    for (int k = 0; k < kSteps; ++k) {
      const double x = half_length * (k + 0.5) / kSteps;
      moment += (a * half_tread - x * x) / std::sqrt(a * a + x * x);
    }
    (moment < 0.0 ? low : high) = a;
  }
  // Belt width, motor friction on the belt and the load's distribution are left out of the formula:
  // 5 %.
  EXPECT_NEAR(distance / (angle * half_tread), (low + half_tread) / half_tread,
              0.05 * (low + half_tread) / half_tread);
}

// Forces between belt and ground are internal to nothing else: on frictionless ground the tracks
// cannot move the robot.
TEST(VehiclePhysics, NoFrictionNoTraction) {
  VehicleOptions options;
  options.track_friction = 1e-9;
  Bench bench(HeightField::flat(10.0, 0.1), options);
  bench.put_down(0, 0);
  bench.run(1.0);
  const double begin = bench.vehicle.chassis().pose.translation().x();
  bench.run(2.0, 7.2, 7.2);
  EXPECT_NEAR(bench.vehicle.chassis().pose.translation().x(), begin, 1e-6);
  EXPECT_GT(bench.vehicle.track_speed_m_per_s(kLeft), 0.2);
}

TEST(VehiclePhysics, HalvingTheStepChangesLittle) {
  const auto distance = [](double step) {
    WorldOptions options = drive_options(0.15, 20.0);
    options.physics_step_s = step;
    options.imu = ImuErrors::none();
    TestDrive drive(
        HeightField::from_function(
            201, 201, 0.05, false,
            [](double x, double y) { return 0.02 * std::sin(4.0 * x) * std::cos(3.0 * y); }),
        options);
    drive.run(10.0);
    return drive.position();
  };
  EXPECT_LT((distance(0.001) - distance(0.0005)).norm(), 0.02);
}

TEST(VehiclePhysics, AttitudeConventions) {
  const Attitude nose_up = {0.0, 0.3, 0.0};
  EXPECT_GT(rotation_from(nose_up)(2, 0), 0.0);
  const Attitude left_up = {0.3, 0.0, 0.0};
  EXPECT_GT(rotation_from(left_up)(2, 1), 0.0);
  const Attitude all = {0.4, -0.3, 2.0};
  const Attitude back = attitude_of(rotation_from(all));
  EXPECT_NEAR(back.roll, all.roll, 1e-12);
  EXPECT_NEAR(back.pitch, all.pitch, 1e-12);
  EXPECT_NEAR(back.heading, all.heading, 1e-12);
}

}  // namespace
}  // namespace screed::testing
