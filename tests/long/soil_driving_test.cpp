// Closed loop on soil: the tracks' springy hold on the ground must not swing with the firmware's
// loops, a robot keeps its heading, and one that stands must come to rest.
// Long: robots drive for minutes on soil.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <tuple>

#include "host_sim/physics/soil/soil_bed.h"
#include "host_sim/physics/terrain/terrain_statistics.h"
#include "tests/sitl/test_drive.h"

namespace screed::testing {
namespace {

constexpr double kDeg = std::numbers::pi / 180.0;

/// A soil that hardly supports the robot: its friction angle is half of most.
SoilParameters weak_soil() {
  SoilParameters soil = soil_preset("viper");
  soil.k_phi = 1161187.0;
  soil.k_c = 6745.0;
  soil.exponent = 0.65;
  soil.friction_deg = 16.9;
  soil.repose_deg = 16.9;
  soil.shear_modulus_m = 0.0234;
  return soil;
}

/// Driven straight on for 12 s from standstill on level soil; the last eight count.
struct StraightOn {
  double swing_deg_per_s = 0.0;  ///< standard deviation of the rate of yaw
  double turned_deg = 0.0;
};

StraightOn straight_on(const SoilParameters& soil, double speed_m_per_s,
                       const Parameters& parameters) {
  WorldOptions options = drive_options(speed_m_per_s, 0.0);
  options.soil = soil;
  options.starts[0].x_m = -1.2;
  TestDrive drive(HeightField::flat(4.0, 0.005), options, parameters);
  if (!drive.start()) ADD_FAILURE() << "does not start";
  drive.run(4.0);
  constexpr int kTicks = 8 * kTickRate_hz;
  double sum = 0.0;
  double squares = 0.0;
  for (int i = 0; i < kTicks; ++i) {
    drive.tick();
    const double rate = drive.yaw_rate() / kDeg;
    sum += rate / kTicks;
    squares += rate * rate / kTicks;
  }
  return {std::sqrt(squares - sum * sum), sum * kTicks / kTickRate_hz};
}

// Tracks on soil swing in yaw at 2 to 6 Hz. With a yaw-rate loop that answers there, the robot
// wagged with 20 to 50 degrees/s for ever.
TEST(SoilDriving, DrivesStraightOnWithoutSwinging) {
  const struct {
    SoilParameters soil;
    double speed_m_per_s;
  } kDrives[] = {{soil_preset("viper"), 0.15},     {soil_preset("lete_sand"), 0.15},
                 {soil_preset("clay"), 0.15},      {soil_preset("dry_sand"), 0.15},
                 {soil_preset("ding_2011"), 0.15}, {weak_soil(), 0.15},
                 {soil_preset("viper"), 0.05},     {weak_soil(), 0.05}};
  for (const auto& [soil, speed] : kDrives) {
    const StraightOn result = straight_on(soil, speed, drive_parameters());
    EXPECT_LT(result.swing_deg_per_s, 1.5) << soil.name << " " << speed;
    EXPECT_LT(std::abs(result.turned_deg), 2.0) << soil.name << " " << speed;
  }
}

// The loop's margin: twice its gain does not swing either.
TEST(SoilDriving, ToleratesTwiceTheYawGain) {
  Parameters parameters = drive_parameters();
  parameters.yaw_ki() = static_cast<int16_t>(2 * parameters.yaw_ki());
  for (const char* soil : {"viper", "lete_sand", "ding_2011"}) {
    EXPECT_LT(straight_on(soil_preset(soil), 0.15, parameters).swing_deg_per_s, 1.5) << soil;
  }
}

// Along a slope at full speed the tracks have no room left for a turn: the speed is reduced, and
// what the slope turned the robot by is turned back. Tracks with a tread are still turned by up to
// 1.03 degrees when the first second ends: they leave the heap around the place where they stood.
TEST(SoilDriving, KeepsItsHeadingAtFullSpeed) {
  for (const char* soil : {"viper", "dry_sand", "clay"}) {
    for (const auto& [speed, lug_height_m, first] :
         {std::tuple{0.25, 0.0, 1}, std::tuple{-0.25, 0.0, 1}, std::tuple{0.25, 0.002, 2}}) {
      WorldOptions options = drive_options(speed, 0.0);
      options.vehicle.lug_height_m = lug_height_m;
      options.soil = soil_preset(soil);
      options.starts[0].y_m = speed > 0.0 ? -2.0 : 2.0;
      options.starts[0].attitude.heading = 90.0 * kDeg;
      TestDrive drive(HeightField::ramp(6.0, 0.01, 5.0), options);
      ASSERT_TRUE(drive.start());
      const double start = drive.attitude().heading;
      for (int second = 1; second <= 15; ++second) {
        drive.run(1.0);
        const double turned =
            std::remainder(drive.attitude().heading - start, 2.0 * std::numbers::pi);
        if (second < first) continue;
        EXPECT_LT(std::abs(turned) / kDeg, 1.0)
            << soil << " " << speed << ", tread " << lug_height_m << ", " << second << " s";
      }
    }
  }
}

// Put down level on a slope it drops onto its tracks and swings. That dies away; until then the
// firmware cannot learn the gyro's bias.
TEST(SoilDriving, ComesToRest) {
  for (const char* soil : {"viper", "lete_sand", "clay"}) {
    WorldOptions options;
    options.soil = soil_preset(soil);
    TestDrive drive(HeightField::ramp(2.0, 0.005, 3.0), options);
    drive.run(3.0);
    double fastest = 0.0;
    for (int i = 0; i < kTickRate_hz; ++i) {
      drive.tick();
      const ChassisState chassis = drive.world.vehicle().chassis();
      fastest = std::max(fastest, chassis.omega_body.norm() + chassis.velocity.norm() / 0.1);
    }
    EXPECT_LT(fastest / kDeg, 0.5) << soil;
    EXPECT_TRUE(drive.robot.attitude().at_rest()) << soil;
  }
}

// Ten minutes of spinning on peaks with all that moves material: not a unit is lost, what is in
// hand was taken before, and no robot that digs itself in is thrown out of its pit.
TEST(SoilDriving, TenMinutesOfDigging) {
  for (const char* name : {"gravel", "viper"}) {
    WorldOptions options = drive_options(0.0, 0.0);
    options.soil = soil_preset(name);
    options.soil->slip_layer_m = 0.002;
    options.soil->compaction = 0.3;
    options.physics_step_s = 0.005;
    Parameters parameters = drive_parameters();
    parameters.algorithm() = static_cast<int16_t>(LevelingAlgorithm::kSpinOnPeak);
    const auto bumps = [](double x, double y) {
      return 0.02 * std::sin(2.0 * std::numbers::pi * x) * std::sin(2.0 * std::numbers::pi * y);
    };
    TestDrive drive(HeightField::from_function(150, 150, 0.01, true, bumps), options, parameters);
    ASSERT_TRUE(drive.start()) << name;
    const HeightField before = drive.world.terrain();
    for (int i = 0; i < 600 * kTickRate_hz; ++i) {
      drive.tick();
      const VolumeBalance balance = drive.world.plant().volume_balance();
      ASSERT_EQ(balance.error(), 0) << name << ", tick " << i;
      ASSERT_GE(balance.in_transit, 0) << name << ", tick " << i;
      ASSERT_LT(drive.world.vehicle().chassis().velocity.z(), 0.2) << name << ", tick " << i;
    }
    EXPECT_GT(drive.world.plant().volume_balance().compacted, 0) << name;
    EXPECT_GT(terrain_change(before, drive.world.terrain()).moved_m3(), 1e-4) << name;
  }
}

}  // namespace
}  // namespace screed::testing
