// The robot on its four wheels alone: two motors, each geared to both wheels of its side.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "host_sim/core/constants.h"
#include "host_sim/soil_validation/wheel_testbed.h"
#include "tests/sitl/test_drive.h"
#include "tests/step_one.h"

namespace screed::testing {
namespace {

constexpr double kDeg = std::numbers::pi / 180.0;
constexpr double kStep_s = 0.001;

WorldOptions wheels(double speed_m_per_s, double yaw_rate_deg_per_s) {
  WorldOptions options = drive_options(speed_m_per_s, yaw_rate_deg_per_s);
  options.vehicle.tracks = false;
  return options;
}

Plant wheeled_plant(HeightField ground, const WorldOptions& options = wheels(0.0, 0.0)) {
  return Plant(std::move(ground), rover5(), options);
}

void run(Plant& plant, double seconds, double left, double right) {
  const int64_t steps = std::lround(seconds / kStep_s);
  for (int64_t i = 0; i < steps; ++i) testing::step_one(plant, {left, right});
}

TEST(WheeledRover, DrivesStraightAtTheOrderedSpeed) {
  TestDrive drive(HeightField::flat(10.0, 0.1), wheels(0.1, 0.0));
  ASSERT_TRUE(drive.start());
  drive.run(1.0);
  const Eigen::Vector3d begin = drive.position();
  drive.run(10.0);
  const Eigen::Vector3d displacement = drive.position() - begin;
  EXPECT_NEAR(displacement.norm(), 1.0, 0.05);
  EXPECT_NEAR(drive.attitude().pitch, 0.0, 0.5 * kDeg);
  EXPECT_EQ(drive.robot.supervisor().faults(), 0);
}

TEST(WheeledRover, RollsAtTheSpeedOfItsWheels) {
  Plant plant = wheeled_plant(HeightField::flat(10.0, 0.1));
  run(plant, 1.0, 0.5, 0.5);
  const double begin = plant.robot(0).vehicle().chassis().pose.translation().x();
  const double angle = plant.robot(0).vehicle().shaft_angle_rad(kLeft);
  run(plant, 3.0, 0.5, 0.5);
  const double rolled = (plant.robot(0).vehicle().shaft_angle_rad(kLeft) - angle) * 0.03;
  EXPECT_NEAR(plant.robot(0).vehicle().chassis().pose.translation().x() - begin, rolled,
              0.02 * rolled);
}

// Turning in place every wheel slides sideways: with wheel spacing L and tread B, equal loads and
// Coulomb friction the moments balance when the slip s along the wheels is (L/B) of the sideways
// one, w L / 2 (L/B): the robot turns at 1 / (1 + (L/B)^2) of the kinematic rate. Belts of the same
// length, loaded evenly all along, turn faster.
TEST(WheeledRover, SkidTurnFollowsTheMomentBalance) {
  Plant plant = wheeled_plant(HeightField::flat(10.0, 0.1));
  run(plant, 2.0, -0.6, 0.6);
  double turned = 0.0;
  const double angle = plant.robot(0).vehicle().shaft_angle_rad(kRight);
  for (int i = 0; i < 3000; ++i) {
    testing::step_one(plant, {-0.6, 0.6});
    turned += plant.robot(0).vehicle().chassis().omega_body.z() * kStep_s;
  }
  const double tread = plant.robot(0).vehicle().tread_m();
  const double kinematic =
      (plant.robot(0).vehicle().shaft_angle_rad(kRight) - angle) * 0.03 / (0.5 * tread);
  const double expected = 1.0 / (1.0 + std::pow(0.185 / tread, 2));
  EXPECT_NEAR(turned / kinematic, expected, 0.05 * expected);
}

// The gyroscope closes the loop: the ordered rate is kept however much the wheels slip.
TEST(WheeledRover, KeepsTheOrderedTurnRate) {
  TestDrive drive(HeightField::flat(10.0, 0.1), wheels(0.0, 30.0));
  ASSERT_TRUE(drive.start());
  drive.run(3.0);
  double turned = 0.0;
  for (int i = 0; i < 3 * kTickRate_hz; ++i) {
    drive.tick();
    turned += drive.yaw_rate() / kTickRate_hz;
  }
  EXPECT_NEAR(turned / kDeg, 90.0, 0.05 * 90.0);
}

TEST(WheeledRover, ClimbsTwentyDegrees) {
  WorldOptions options = wheels(0.1, 0.0);
  options.starts[0].x_m = -4.0;
  TestDrive drive(HeightField::ramp(10.0, 0.1, 20.0), options);
  ASSERT_TRUE(drive.start());
  const Eigen::Vector3d begin = drive.position();
  drive.run(20.0);
  const Eigen::Vector3d displacement = drive.position() - begin;
  EXPECT_NEAR(displacement.norm(), 2.0, 0.1);
  EXPECT_NEAR(displacement.z(), displacement.norm() * std::sin(20.0 * kDeg), 0.01);
  EXPECT_EQ(drive.robot.supervisor().faults(), 0);
}

// What the shafts put out is found again as height, less what slip and the tyres' damping take.
TEST(WheeledRover, WorkOfTheShaftsLiftsTheRobot) {
  WorldOptions options = wheels(0.0, 0.0);
  options.starts[0].x_m = -2.0;
  options.starts[0].attitude.pitch = 10.0 * kDeg;
  Plant plant = wheeled_plant(HeightField::ramp(10.0, 0.1, 10.0), options);
  run(plant, 1.0, 0.7, 0.7);
  const GearMotor motor;
  const double begin = plant.robot(0).vehicle().chassis().pose.translation().z();
  double work = 0.0;
  for (int i = 0; i < 5000; ++i) {
    testing::step_one(plant, {0.7, 0.7});
    for (const Side side : {kLeft, kRight}) {
      const double torque = motor.torque_per_ampere() * plant.robot(0).vehicle().current_a(side) -
                            motor.friction_torque();
      work += torque * plant.robot(0).vehicle().track_speed_m_per_s(side) / 0.03 * kStep_s;
    }
  }
  const double lifted = plant.robot(0).vehicle().mass_kg() * kGravity_m_per_s2 *
                        (plant.robot(0).vehicle().chassis().pose.translation().z() - begin);
  EXPECT_GT(lifted, 1.0);
  EXPECT_GT(work, lifted);
  EXPECT_LT(work, 1.15 * lifted);
}

TEST(WheeledRover, StandsStill) {
  WorldOptions options = wheels(0.0, 0.0);
  options.starts[0].attitude.pitch = 20.0 * kDeg;
  Plant plant = wheeled_plant(HeightField::ramp(10.0, 0.1, 20.0), options);
  const Eigen::Vector3d begin = plant.robot(0).vehicle().chassis().pose.translation();
  run(plant, 10.0, 0.0, 0.0);
  EXPECT_LT((plant.robot(0).vehicle().chassis().pose.translation() - begin).norm(), 1e-4);
  EXPECT_LT(plant.robot(0).vehicle().chassis().velocity.norm(), 1e-6);
}

/// Slip at which four wheels on untouched and rutted soil pull as much as they are held back: two
/// go ahead, two follow in their ruts, all bear a quarter.
double own_slip(const SoilParameters& soil) {
  double low = -0.2;
  double high = 0.95;
  for (int i = 0; i < 40; ++i) {
    RollingWheel wheel;
    wheel.width_m = 0.03;
    wheel.load_n = 0.25 * 1.2 * 9.81;
    wheel.slip = 0.5 * (low + high);
    const WheelReaction ahead = wheel_limit(wheel, soil, NormalStress::kRadial);
    wheel.rut_m = ahead.rut_m;
    const WheelReaction behind = wheel_limit(wheel, soil, NormalStress::kRadial);
    (ahead.drawbar_pull_n + behind.drawbar_pull_n < 0.0 ? low : high) = wheel.slip;
  }
  return 0.5 * (low + high);
}

// On firm sand the wheels slip a little, on loose sand a lot: they sink in by some millimetres, and
// the robot drives as fast as the limit of an infinitely fine grid says. First it has to come out
// of the dents in which it stood; when it does is chance. On viper as it is they hold it for ever:
// a wheel of 30 mm that spins there pulls less than the soil it has pushed aside holds it back.
TEST(WheeledRover, TheFirmwareDrivesItOnSoil) {
  SoilParameters quick = soil_preset("viper");
  quick.name = "viper with a small K";
  quick.shear_modulus_m = 0.002;
  for (const SoilParameters& soil : {soil_preset("lete_sand"), quick, soil_preset("ding_2011")}) {
    SCOPED_TRACE(soil.name);
    WorldOptions options = wheels(0.1, 0.0);
    options.soil = soil;
    options.starts[0].x_m = -0.7;
    TestDrive drive(HeightField::flat(2.0, 0.005), options);
    ASSERT_TRUE(drive.start());
    Eigen::Vector3d begin = drive.position();
    double steepest = 0.0;
    double fastest = 0.0;  // up or down
    for (int i = 0; i < 13 * kTickRate_hz; ++i) {
      if (i == 5 * kTickRate_hz) begin = drive.position();
      drive.tick();
      steepest =
          std::max({steepest, std::abs(drive.attitude().pitch), std::abs(drive.attitude().roll)});
      fastest = std::max(fastest, std::abs(drive.world.vehicle().chassis().velocity.z()));
    }
    const double displacement = (drive.position() - begin).norm();
    EXPECT_NEAR(displacement / (0.8 * (1.0 - own_slip(*options.soil))), 1.0, 0.05);
    EXPECT_LT(steepest, 5.0 * kDeg);
    EXPECT_LT(fastest, 0.05);
    EXPECT_EQ(drive.world.plant().volume_balance().error(), 0);
    EXPECT_EQ(drive.robot.supervisor().faults(), 0);
  }
}

}  // namespace
}  // namespace screed::testing
