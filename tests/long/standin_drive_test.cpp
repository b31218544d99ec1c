// The firmware drives in the closed-form world that stands in for the physics, and notices nothing.
// Long: minutes of driving, beside the physics where they are compared.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include "host_sim/core/errors.h"
#include "host_sim/standin/standin_plant.h"
#include "tests/sitl/test_drive.h"

namespace screed {
namespace {

using testing::rover5;

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

WorldOptions on_soil(const char* preset = "viper") {
  WorldOptions options;
  options.soil = soil_preset(preset);
  return options;
}

struct StandInDrive : testing::TestDrive {
  StandInDrive(const HeightField& ground, const WorldOptions& options)
      : TestDrive(std::make_unique<StandInPlant>(ground, rover5(), options), options) {}

  Eigen::Vector3d place() const { return world.plant().robot(0).unwrapped_position(); }
};

TEST(StandInDrive, FirmwareDrivesStraightAtTheCommandedSpeed) {
  WorldOptions options = on_soil();
  options.robots[0].drive = DriveCommand{0.1, 0.0};
  StandInDrive drive(HeightField::flat(4.0, 0.02), options);
  drive.run(8.0);
  ASSERT_TRUE(drive.robot.supervisor().running());
  const Eigen::Vector3d begin = drive.place();
  drive.run(10.0);
  EXPECT_NEAR((drive.place() - begin).norm(), 1.0, 0.05);  // less what slips
  EXPECT_EQ(drive.robot.supervisor().faults(), 0);
}

TEST(StandInDrive, FirmwareTurnsAtTheCommandedRateAndSensorsFeelTheSlope) {
  WorldOptions options = on_soil();
  options.robots[0].drive = DriveCommand{0.0, 30.0};
  StandInDrive drive(HeightField::ramp(4.0, 0.02, 6.0), options);
  drive.run(8.0);
  const double before = attitude_of(drive.world.vehicle().chassis().pose.linear()).heading;
  drive.run(2.0);
  const double after = attitude_of(drive.world.vehicle().chassis().pose.linear()).heading;
  EXPECT_NEAR(std::remainder(after - before, 360.0 * kRadPerDeg), 60.0 * kRadPerDeg,
              6.0 * kRadPerDeg);
  const Attitude truth = attitude_of(drive.world.vehicle().chassis().pose.linear());
  EXPECT_NEAR(std::hypot(truth.pitch, truth.roll), 6.0 * kRadPerDeg, 2.0 * kRadPerDeg);
  EXPECT_NEAR(drive.robot.attitude().pitch() * std::numbers::pi / 32768.0, truth.pitch,
              2.0 * kRadPerDeg);
  EXPECT_NEAR(drive.robot.attitude().roll() * std::numbers::pi / 32768.0, truth.roll,
              2.0 * kRadPerDeg);
}

TEST(StandInDrive, WhatIsNotDrivenStays) {
  for (const char* preset : {"viper", "gravel", "clay"}) {
    WorldOptions options = on_soil(preset);
    options.ground_station_arms = false;
    StandInDrive drive(HeightField::ramp(2.0, 0.02, 12.0), options);
    drive.run(10.0);
    const Eigen::Vector3d begin = drive.place();
    drive.run(60.0);
    EXPECT_LT((drive.place() - begin).norm(), 1e-3) << preset;
  }
}

TEST(StandInDrive, WrapsAroundAndKeepsTheWayMade) {
  WorldOptions options = on_soil();
  options.robots[0].drive = DriveCommand{0.2, 0.0};
  StandInDrive drive(
      HeightField::from_function(80, 80, 0.02, true, [](double, double) { return 0.0; }), options);
  drive.run(20.0);
  EXPECT_GT(drive.place().x(), 1.6);
  EXPECT_GT(drive.world.plant().robot(0).wrap_counts()[0], 0);
  EXPECT_LT(std::abs(drive.world.vehicle().chassis().pose.translation().x()), 0.81);
}

TEST(StandInDrive, StaysBetweenWallsAndTurnsAlongThem) {
  for (const double heading_deg : {0.0, 40.0}) {
    WorldOptions options = on_soil();
    options.robots[0].drive = DriveCommand{0.2, 0.0};
    options.starts[0].attitude.heading = heading_deg * kRadPerDeg;
    HeightField field = HeightField::flat(1.6, 0.02);
    field.add_walls();
    StandInDrive drive(field, options);
    drive.run(20.0);
    // The Rover's middle stays half a length and more from the wall.
    EXPECT_LT(drive.place().x(), 0.8 - 0.1) << heading_deg;
    EXPECT_LT(std::abs(drive.place().y()), 0.8 - 0.1) << heading_deg;
    EXPECT_GT(drive.place().x(), 0.5) << heading_deg;
  }
  WorldOptions beyond = on_soil();
  beyond.starts[0].x_m = 0.75;
  HeightField field = HeightField::flat(1.6, 0.02);
  field.add_walls();
  EXPECT_THROW(StandInPlant(field, rover5(), beyond), InputError);
}

TEST(StandInDrive, LaidOnItsSideItFaultsAndStays) {
  WorldOptions options = on_soil();
  options.robots[0].drive = DriveCommand{0.1, 0.0};
  StandInDrive drive(HeightField::flat(2.0, 0.02), options);
  drive.run(8.0);
  drive.world.plant().robot(0).lay_on_side();
  const Eigen::Vector3d begin = drive.place();
  drive.run(3.0);
  EXPECT_NE(drive.robot.supervisor().faults(), 0);
  EXPECT_EQ((drive.place() - begin).norm(), 0.0);
}

// Two robots drive at each other: neither passes through the other.
TEST(StandInPlant, RobotsMeet) {
  PlantOptions options;
  options.soil = soil_preset("viper");
  options.starts = {{-0.25, 0.0, {}, {0.0, 0.0, 0.0}},
                    {0.25, 0.0, {}, {0.0, 0.0, std::numbers::pi}}};
  StandInPlant plant(HeightField::flat(2.0, 0.02), rover5(), options);
  const DutyRatio ahead{0.6, 0.6};
  for (int i = 0; i < 10 * kTickRate_hz * plant.steps_per_tick(); ++i) {
    plant.step(std::array{ahead, ahead});
  }
  const double apart =
      (plant.robot(0).unwrapped_position() - plant.robot(1).unwrapped_position()).head<2>().norm();
  EXPECT_GT(apart, 0.19);
  EXPECT_LT(plant.robot(0).unwrapped_position().x(), plant.robot(1).unwrapped_position().x());
  options.starts = {options.starts[0], {-0.2, 0.0, {}, {0.0, 0.0, 0.0}}};
  EXPECT_THROW(StandInPlant(HeightField::flat(2.0, 0.02), rover5(), options), InputError);
}

TEST(StandInPlant, RefusesWhatItDoesNotKnow) {
  PlantOptions rigid;
  EXPECT_THROW(StandInPlant(HeightField::flat(2.0, 0.02), rover5(), rigid), InputError);
  PlantOptions wheels;
  wheels.soil = soil_preset("viper");
  wheels.vehicle.tracks = false;
  EXPECT_THROW(StandInPlant(HeightField::flat(2.0, 0.02), rover5(), wheels), InputError);
}

}  // namespace
}  // namespace screed
