// Soil under a driving robot: volume, slopes, stability, repeatability, memory.
#include "host_sim/physics/soil/soil_bed.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <thread>
#include <vector>

#include "host_sim/physics/vehicle/urdf/urdf_importer.h"
#include "host_sim/physics/vehicle/vehicle.h"
#include "host_sim/soil_validation/bed_trials.h"
#include "paths.h"
#include "tests/sanitizers.h"
#include "tests/unit/allocations.h"

namespace screed {
namespace {

constexpr double kStep_s = 1e-3;
constexpr int kDrivenSteps = testing::kSanitized ? 5000 : 20000;

HeightField waves(double size_m, double cell_m, double relief_m, bool wrap) {
  const int nodes = static_cast<int>(std::lround(size_m / cell_m)) + (wrap ? 0 : 1);
  const double k = 2.0 * std::numbers::pi / (nodes * cell_m);
  return HeightField::from_function(nodes, nodes, cell_m, wrap, [=](double x, double y) {
    return 0.5 * relief_m * std::sin(2.0 * k * x) * std::cos(3.0 * k * y);
  });
}

/// Every unit is accounted for at any moment, with material pushed aside and slopes sliding, on a
/// bed with edges and on one without, whatever share is compacted.
TEST(SoilBedTest, VolumeIsExactWhileDriving) {
  for (const bool wrap : {false, true}) {
    for (const auto& [compaction, slip_layer_m] : {std::pair{0.0, 0.0}, {0.37, 0.002}}) {
      SoilParameters soil = soil_preset("viper");
      soil.compaction = compaction;
      soil.slip_layer_m = slip_layer_m;
      SoilBed bed(waves(1.5, 0.01, 0.04, wrap), soil);
      const int64_t before = bed.balance().now;
      SoilRobot robot(bed, {}, 0.2, 0.1);
      for (int i = 0; i < kDrivenSteps; ++i) {
        // Ahead, then a spin in place, again and again.
        const bool spin = i % 4000 >= 3000;
        robot.step(spin ? -0.2 : 0.2, 0.2, kStep_s);
        ASSERT_GE(bed.balance().in_transit, 0) << i;
        if (i % 500 != 0) continue;
        ASSERT_EQ(bed.balance().error(), 0) << i;
        ASSERT_EQ(bed.balance().before, before);
        ASSERT_EQ(bed.surface().height_sum(), bed.balance().now);
      }
      bed.relax_slopes();
      const VolumeBalance end = bed.balance();
      EXPECT_EQ(end.error(), 0);
      if (compaction == 0.0) {
        EXPECT_EQ(end.compacted, 0);
        EXPECT_EQ(end.now + end.in_transit, before);
      } else {
        EXPECT_GT(end.compacted, 0);
        EXPECT_LT(end.now, before);
      }
      EXPECT_LE(repose_excess_units(bed.surface(), soil.repose_deg), 1.0);
    }
  }
}

// Without pushing aside what is sunk is compacted: all of it.
TEST(SoilBedTest, WithoutBulldozingSunkMaterialIsCompacted) {
  SoilOptions options;
  options.bulldozing = false;
  options.avalanches = false;
  SoilBed bed(HeightField::flat(1.0, 0.01), soil_preset("viper"), options);
  SoilRobot robot(bed, {}, 0.0, 0.0);
  for (int i = 0; i < 3000; ++i) robot.step(0.2, 0.2, kStep_s);
  EXPECT_EQ(bed.balance().error(), 0);
  EXPECT_EQ(bed.balance().in_transit, 0);
  EXPECT_GT(bed.balance().compacted, 0);
  EXPECT_EQ(bed.balance().now, bed.balance().before - bed.balance().compacted);
}

// A tower on plain ground becomes a heap whose flanks lie at the angle of repose.
TEST(SoilBedTest, SlopesSettleAtTheAngleOfRepose) {
  for (const bool wrap : {false, true}) {
    for (const double repose_deg : {20.0, 30.0, 45.0}) {
      ReposeTest test;
      test.soil = soil_preset("viper");
      test.soil.repose_deg = repose_deg;
      test.cell_m = 0.01;
      test.size_m = 0.8;
      test.wrap = wrap;
      test.centre_x_m = wrap ? 0.35 : 0.0;  // over the edge
      const ReposeResult result = collapse(test);
      EXPECT_GT(result.moves, 1000);
      EXPECT_EQ(result.volume_error, 0);
      EXPECT_LE(result.excess_units, 1.0) << repose_deg;
      EXPECT_NEAR(result.slope_axis_deg, repose_deg, 0.5);
      EXPECT_NEAR(result.slope_diagonal_deg, repose_deg, 0.5);
    }
  }
}

/// Greatest excess over the angle of repose, in units of height, of two neighbours of which none
/// waits to be looked at.
double forgotten_excess_units(const SoilBed& bed) {
  const HeightField& field = bed.surface();
  const Height* const heights = field.heights();
  const int nx = field.nx();
  const int ny = field.ny();
  const double slope = std::tan(bed.soil().repose_deg * std::numbers::pi / 180.0);
  double most = -std::numeric_limits<double>::infinity();
  for (const auto& [dx, dy] : {std::pair{1, 0}, {0, 1}, {1, 1}, {1, -1}}) {
    const double limit = slope * field.spacing_m() * std::hypot(dx, dy) / kHeightUnit_m;
    for (int y = 0; y < ny; ++y) {
      const int beside_y = (y + dy + ny) % ny;
      for (int x = 0; x < nx; ++x) {
        const int beside_x = (x + dx) % nx;
        const double excess =
            std::abs(heights[y * nx + x] - heights[beside_y * nx + beside_x]) - limit;
        if (excess <= most) continue;
        if (bed.is_slope_queued(x, y) || bed.is_slope_queued(beside_x, beside_y)) continue;
        most = excess;
      }
    }
  }
  return most;
}

// While a robot drives, after every step: no slope is above the angle of repose by more than a unit
// but where the robot stands, as its wheels hold what lies below and beside them. No step of this
// drive has more to slide than it has time for.
TEST(SoilBedTest, SlopesStayBelowTheAngleOfReposeWhileDriving) {
  for (const char* name : {"viper", "gravel"}) {
    SoilBed bed(waves(1.0, 0.01, 0.04, true), soil_preset(name));
    bed.relax_slopes();
    SoilRobot robot(bed, {}, 0.2, 0.1);
    for (int i = 0; i < 2000; ++i) {
      robot.step(i % 1000 < 700 ? 0.2 : -0.2, 0.2, kStep_s);
      ASSERT_EQ(bed.slopes_left(), 0U) << name << ", step " << i;
      ASSERT_LE(forgotten_excess_units(bed), 1.0) << name << ", step " << i;
    }
    bed.end_step();  // without the robot
    bed.end_step();
    EXPECT_LE(repose_excess_units(bed.surface(), bed.soil().repose_deg), 1.0) << name;
  }
}

TEST(SoilBedTest, SteepTerrainSlidesUntouched) {
  ReposeTest test;
  test.soil = soil_preset("viper");
  test.cell_m = 0.01;
  test.tap_m = 0.0;
  const ReposeResult result = collapse(test);
  EXPECT_GT(result.moves, 1000);
  EXPECT_LE(result.excess_units, 1.0);
  EXPECT_EQ(result.volume_error, 0);
}

TEST(SoilBedTest, ASlopeBelowTheAngleOfReposeStays) {
  SoilBed bed(HeightField::ramp(0.5, 0.01, 29.0), soil_preset("viper"));
  EXPECT_EQ(bed.relax_slopes(), 0);
}

/// Way of a robot in a fixed run, and what it did to the bed.
struct DrivenRun {
  std::string hash;
  Eigen::Vector3d place;
};

DrivenRun fixed_run(double size_m, const char* soil = "viper") {
  // Cells of a power of two: then the nodes of beds of any size lie at the same bits.
  constexpr double kCell_m = 0x1p-8;
  SoilBed bed(HeightField::flat(size_m, kCell_m), soil_preset(soil));
  SoilRobot robot(bed, {}, 0.0, 0.0);
  for (int i = 0; i < 2500; ++i) robot.step(0.15, 0.2, kStep_s);
  return {surface_hash(bed.surface()), robot.position()};
}

TEST(SoilBedTest, TheSameRunGivesTheSameBits) {
  const DrivenRun first = fixed_run(1.5);
  const DrivenRun second = fixed_run(1.5);
  EXPECT_EQ(first.hash, second.hash);
  EXPECT_EQ(first.place, second.place);
}

// Worlds side by side share nothing.
TEST(SoilBedTest, AnyNumberOfThreadsGivesTheSameBits) {
  const DrivenRun alone = fixed_run(1.5, "gravel");
  std::array<DrivenRun, 3> together;
  std::vector<std::thread> threads;
  threads.reserve(together.size());
  for (DrivenRun& run : together) threads.emplace_back([&run] { run = fixed_run(1.5, "gravel"); });
  for (std::thread& thread : threads) thread.join();
  for (const DrivenRun& run : together) {
    EXPECT_EQ(run.hash, alone.hash);
    EXPECT_EQ(run.place, alone.place);
  }
}

TEST(SoilBedTest, TheBedsSizeDoesNotMatter) {
  EXPECT_EQ(fixed_run(1.5).place, fixed_run(3.0).place);
}

// What is touched reaches its greatest size early; from then on nothing is allocated.
TEST(SoilBedTest, SteadySteppingAllocatesNothing) {
  SoilParameters sinks = soil_preset("viper");
  sinks.slip_bearing = 0.3;
  for (const SoilParameters& soil : {soil_preset("viper"), sinks, soil_preset("gravel")}) {
    SoilBed bed(HeightField::flat(1.5, 0.005), soil);
    SoilRobot robot(bed, {}, -0.3, 0.0);
    const auto drive = [&](int steps) {
      for (int i = 0; i < steps; ++i) robot.step(0.15, 0.2, kStep_s);
    };
    drive(1500);
    const long before = testing::allocations();
    drive(1500);
    const long after = testing::allocations();
    EXPECT_EQ(after, before) << soil.name << ", slip_bearing " << soil.slip_bearing;
  }
}

/// Greatest depth, at right angles to the slope, of the rut that a belt or wheel leaves which goes
/// down or up a slope, always so deep in it.
double rut_on_slope(const Footprint& shape, double slope_deg, double depth_m, double sense) {
  constexpr double kSpeed = 0.1;
  SoilOptions options;
  options.bulldozing = options.avalanches = false;
  SoilBed bed(HeightField::ramp(1.0, 0.005, slope_deg), soil_preset("viper"), options);
  const HeightField before = bed.surface();
  Footprint footprint = shape;
  ContactMemory memory;
  FootprintMotion motion;
  motion.mass_kg = std::numeric_limits<double>::infinity();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(-slope_deg * std::numbers::pi / 180.0, Eigen::Vector3d::UnitY())
                      .toRotationMatrix();
  motion.velocity = sense * kSpeed * pose.linear().col(0);
  for (int i = 0; i < 1500; ++i) {
    pose.translation() = pose.linear().col(0) * (sense * kSpeed * (2 * i * kStep_s - 1.5)) +
                         pose.linear().col(2) * (shape.radius() - depth_m);
    footprint.set_pose(pose);
    bed.press(footprint, motion, 2.0 * kStep_s, memory);
    bed.end_step();
  }
  double deepest = 0.0;
  for (int iy = 0; iy < before.ny(); ++iy) {
    for (int ix = 0; ix < before.nx(); ++ix) {
      const double fall =
          (static_cast<double>(before.node(ix, iy)) - bed.surface().node(ix, iy)) * kHeightUnit_m;
      deepest = std::max(deepest, fall * pose.linear()(2, 2));
    }
  }
  return deepest;
}

// What lies below a belt that goes downhill was never as low as the belt's front end is by now.
TEST(SoilBedTest, ARutIsAsDeepDownhillAsOnTheLevel) {
  for (const Footprint& shape :
       {Footprint::track(0.07, 0.03, 0.04), Footprint::wheel(0.03, 0.025)}) {
    for (const double slope_deg : {-20.0, 0.0, 10.0}) {
      for (const double sense : {1.0, -1.0}) {
        EXPECT_NEAR(rut_on_slope(shape, slope_deg, 0.004, sense), 0.004, 0.0005)
            << slope_deg << " degrees, sense " << sense << ", half length " << shape.half().x();
      }
    }
  }
}

/// The robot of this project stands for a second on lete_sand with E = 4e8 Pa/m, then drives for
/// five.
struct RoverRun {
  double highest_m = 0.0;        // of Body above where it was put down
  double fastest_m_per_s = 0.0;  // up or down, after the first 0.4 s
  double steepest_rad = 0.0;     // pitch or roll
  double distance_m = 0.0;
  int64_t volume_error = 0;
};

RoverRun rover_on_stiff_soil(bool tracks, double step_s) {
  OdeWorld world;
  VehicleOptions options;
  options.tracks = tracks;
  Vehicle vehicle(world, import_urdf(std::string(kBoardsFolder) + "/a_star_32u4/rover5.urdf"),
                  options);
  SoilParameters soil = soil_preset("lete_sand");
  soil.elastic_pa_per_m = 4e8;
  SoilBed bed(HeightField::flat(2.0, 0.005), soil);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() << -0.5, 0.0, vehicle.resting_height(bed.surface(), -0.5, 0.0, pose.linear());
  vehicle.place(pose);
  RoverRun run;
  const int steps = static_cast<int>(std::lround(6.0 / step_s));
  for (int i = 0; i < steps; ++i) {
    const double voltage = i * step_s < 1.0 ? 0.0 : 4.0;
    vehicle.apply_forces(bed, {voltage, voltage}, step_s);
    world.step(step_s);
    bed.end_step();
    const ChassisState state = vehicle.chassis();
    const Attitude attitude = attitude_of(state.pose.linear());
    run.highest_m = std::max(run.highest_m, state.pose.translation().z() - pose.translation().z());
    run.steepest_rad =
        std::max({run.steepest_rad, std::abs(attitude.pitch), std::abs(attitude.roll)});
    if (i * step_s > 0.4) {
      run.fastest_m_per_s = std::max(run.fastest_m_per_s, std::abs(state.velocity.z()));
    }
  }
  run.distance_m = vehicle.chassis().pose.translation().x() - pose.translation().x();
  run.volume_error = bed.balance().error();
  return run;
}

bool stays_on_the_ground(const RoverRun& run) {
  return run.highest_m < 0.001 && run.fastest_m_per_s < 0.03 && run.steepest_rad < 0.02 &&
         run.distance_m > 0.3 && run.volume_error == 0;
}

TEST(SoilBedTest, TheTrackedRoverIsStableOnStiffSoilAtLongSteps) {
  EXPECT_TRUE(stays_on_the_ground(rover_on_stiff_soil(true, 0.004)));
}

TEST(SoilBedTest, TheWheeledRoverIsStableOnStiffSoilAtLongSteps) {
  for (const double step_s : {0.001, 0.002, 0.004}) {
    const RoverRun run = rover_on_stiff_soil(false, step_s);
    EXPECT_TRUE(stays_on_the_ground(run))
        << "step " << step_s << " s: " << run.highest_m << " m up, " << run.fastest_m_per_s
        << " m/s, " << run.steepest_rad << " rad, " << run.distance_m << " m on";
  }
}

// The pushed material lies ahead and beside: the rut stays, and its material stands next to it.
TEST(SoilBedTest, WhatIsPushedAsideDoesNotFillTheRut) {
  SoilOptions options;
  options.avalanches = false;
  SoilParameters soil = soil_preset("viper");
  soil.shear_modulus_m = 0.002;  // firm enough that four small wheels get on
  SoilBed bed(HeightField::flat(1.0, 0.005), soil, options);
  SoilRobot robot(bed, {}, -0.2, 0.0);
  for (int i = 0; i < 3000; ++i) robot.step(0.2, 0.2, kStep_s);
  ASSERT_GT(robot.position().x(), 0.1);
  // Across the left wheels' track, well behind the robot's end.
  const double x = robot.position().x() - 0.2;
  double lowest = 0.0;
  double highest = 0.0;
  for (double y = 0.05; y < 0.15; y += 0.0025) {
    const double height = bed.surface().at(x, y).height;
    lowest = std::min(lowest, height);
    highest = std::max(highest, height);
  }
  EXPECT_LT(lowest, -0.005);
  EXPECT_GT(highest, 0.002);
}

// What a belt presses comes up beside where it presses: of one that touches all along and goes down
// with its rear end alone, there.
TEST(SoilBedTest, WhatATiltedBeltPressesStaysAtItsEnd) {
  constexpr double kHalf_m = 0.0925;
  constexpr double kRadius_m = 0.03;
  constexpr double kDepth_m = 0.002;  // of its front end
  for (const double heading_deg : {0.0, 30.0}) {
    SoilOptions options;
    options.avalanches = false;
    SoilBed bed(HeightField::flat(1.0, 0.01), soil_preset("viper"), options);
    Footprint belt = Footprint::track(kHalf_m, kRadius_m, 0.03);
    ContactMemory memory;
    FootprintMotion motion;
    motion.mass_kg = std::numeric_limits<double>::infinity();
    const Eigen::AngleAxisd heading(heading_deg * std::numbers::pi / 180.0,
                                    Eigen::Vector3d::UnitZ());
    const auto press = [&](double pitch) {  // nose up, about the front axle
      Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
      pose.linear() =
          (heading * Eigen::AngleAxisd(-pitch, Eigen::Vector3d::UnitY())).toRotationMatrix();
      pose.translation().z() = kRadius_m - kDepth_m - kHalf_m * std::sin(pitch);
      belt.set_pose(pose);
      bed.press(belt, motion, kStep_s, memory);
      bed.end_step();
    };
    motion.velocity.z() = -0.002;
    for (int i = 0; i < 5; ++i) press(0.0);
    const HeightField level = bed.surface();
    for (int i = 1; i <= 200; ++i) press(0.05 * i / 200);
    const Eigen::Vector3d ahead = heading * Eigen::Vector3d::UnitX();
    double raised = 0.0;
    double raised_ahead = 0.0;
    double sunk = 0.0;
    double sunk_ahead = 0.0;
    for (int iy = 0; iy < level.ny(); ++iy) {
      for (int ix = 0; ix < level.nx(); ++ix) {
        const double change = bed.surface().node(ix, iy) - level.node(ix, iy);
        const bool in_front = level.node_x(ix) * ahead.x() + level.node_y(iy) * ahead.y() > 0.0;
        raised += std::max(0.0, change);
        sunk -= std::min(0.0, change);
        if (in_front) raised_ahead += std::max(0.0, change);
        if (in_front) sunk_ahead -= std::min(0.0, change);
      }
    }
    ASSERT_GT(raised, 0.0);
    EXPECT_LT(sunk_ahead, 0.3 * sunk) << "it goes down with its rear";
    EXPECT_NEAR(raised_ahead / raised, sunk_ahead / sunk, 0.1) << heading_deg;
  }
}

TEST(SoilPowerTableTest, IsThePowerAtAnyDepth) {
  for (const double exponent : {0.5, 0.793, 1.1, 1.6}) {
    const PowerTable table(exponent);
    for (double z = 1e-7; z < 0.5; z *= 1.013) {
      EXPECT_NEAR(table.power(z) / std::pow(z, exponent), 1.0, 2e-4) << exponent << ", " << z;
    }
    EXPECT_EQ(table.power(0.0), 0.0);
  }
}

}  // namespace
}  // namespace screed
