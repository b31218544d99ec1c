// Robots between the walls of a bed, on every terrain: they stay in, whatever they try.
// Long: each gear against walls of each terrain.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "host_sim/core/constants.h"
#include "host_sim/core/errors.h"
#include "host_sim/physics/soil/soil_parameters.h"
#include "host_sim/physics/world/wall_clearance.h"
#include "tests/sitl/test_drive.h"
#include "tests/step_one.h"

namespace screed::testing {
namespace {

constexpr double kDeg = std::numbers::pi / 180.0;
constexpr double kStep_s = 0.001;
constexpr double kDepth_m = 0.003;  // into a wall, at most

struct Bed {
  const char* name;
  double size_m;
  double spacing_m;
  bool soil;
  bool particles;
};
constexpr std::array<Bed, 3> kBeds = {{{"Rigid", 1.2, 0.1, false, false},
                                       {"Soil", 1.2, 0.01, true, false},
                                       {"Particles", 0.8, 0.1, false, true}}};

struct Gear {
  const char* name;
  bool tracks;
  TrackModel model;
};
constexpr std::array<Gear, 3> kGears = {{{"Belts", true, TrackModel::kBelt},
                                         {"Chains", true, TrackModel::kChain},
                                         {"Wheels", false, TrackModel::kBelt}}};

PlantOptions options_on(const Bed& bed, const Gear& gear) {
  PlantOptions options;
  options.vehicle.tracks = gear.tracks;
  options.vehicle.track_model = gear.model;
  if (bed.soil) {
    options.soil = soil_preset("lete_sand");
    options.soil->slip_layer_m = gear.tracks ? 0.002 : 0.0;  // wheels would dig themselves in
    options.soil_options.bulldozing = true;
    options.soil_options.avalanches = true;
  }
  if (bed.particles) options.particles.emplace();
  return options;
}

HeightField walled(const Bed& bed) {
  const int nodes = static_cast<int>(std::lround(bed.size_m / bed.spacing_m)) + 1;
  HeightField field = HeightField::from_function(nodes, nodes, bed.spacing_m, false,
                                                 [](double, double) { return 0.1; });
  field.add_walls();
  return field;
}

double depth_in_walls(const Plant& plant, const BedBounds& bed) {
  return out_of_walls(bed, plant.robot(0).vehicle().outline()).cwiseAbs().maxCoeff();
}

/// Drives on and looks after every step.
struct Trial {
  Trial(const Bed& bed, const PlantOptions& options)
      : plant(walled(bed), rover5(), options), bounds{bed.size_m, bed.size_m, BedEdge::kWalled} {}

  void run(double seconds, double left, double right) {
    const int64_t steps = std::lround(seconds / kStep_s);
    for (int64_t i = 0; i < steps; ++i) {
      testing::step_one(plant, {left, right});
      const ChassisState chassis = plant.robot(0).vehicle().chassis();
      deepest = std::max(deepest, depth_in_walls(plant, bounds));
      fastest = std::max(fastest, chassis.velocity.norm());
      highest = std::max(highest, chassis.pose.translation().z());
    }
  }
  Eigen::Vector3d at() const { return plant.robot(0).vehicle().chassis().pose.translation(); }
  double heading() const {
    return attitude_of(plant.robot(0).vehicle().chassis().pose.linear()).heading;
  }

  Plant plant;
  BedBounds bounds;
  double deepest = 0.0;
  double fastest = 0.0;
  double highest = 0.0;
};

struct WallCase {
  Bed bed;
  Gear gear;
};

class Walls : public ::testing::TestWithParam<WallCase> {};

/// Most where it costs least.
std::vector<double> headings_deg(const WallCase& of) {
  if (!of.bed.soil && !of.bed.particles) return {0.0, 20.0, 45.0, 70.0, 180.0};
  if (of.gear.tracks && of.gear.model == TrackModel::kBelt) return {0.0, 45.0};
  return {20.0};
}

// Full voltage for 20 s: it touches the wall, stays inside, and nothing explodes.
TEST_P(Walls, StopARobotThatDrivesIntoThem) {
  for (const double heading_deg : headings_deg(GetParam())) {
    PlantOptions options = options_on(GetParam().bed, GetParam().gear);
    options.starts[0].attitude.heading = heading_deg * kDeg;
    // Into the wall backwards at 180 degrees: with its stern.
    const double forward = heading_deg == 180.0 ? -1.0 : 1.0;
    Trial trial(GetParam().bed, options);
    const double begins_at = trial.at().z();
    trial.run(20.0, forward, forward);
    EXPECT_GT(trial.deepest, 0.0) << heading_deg << ": it never came to a wall";
    EXPECT_LT(trial.deepest, kDepth_m) << heading_deg;
    EXPECT_LT(trial.fastest, 1.0) << heading_deg;
    EXPECT_LT(trial.highest, begins_at + 0.2) << heading_deg << ": it climbed out";
    EXPECT_EQ(trial.plant.volume_balance().error(), 0);
  }
}

TEST_P(Walls, HoldARobotThatSpinsInACorner) {
  PlantOptions options = options_on(GetParam().bed, GetParam().gear);
  options.starts[0].attitude.heading = 45.0 * kDeg;
  Trial trial(GetParam().bed, options);
  trial.run(3.0, 1.0, 1.0);
  trial.run(3.0, -1.0, 1.0);
  trial.run(3.0, 1.0, -0.5);
  EXPECT_GT(trial.deepest, 0.0);
  EXPECT_LT(trial.deepest, kDepth_m);
  EXPECT_LT(trial.fastest, 1.0);
  EXPECT_EQ(trial.plant.volume_balance().error(), 0);
}

std::vector<WallCase> all_cases() {
  std::vector<WallCase> cases;
  for (const Bed& bed : kBeds) {
    for (const Gear& gear : kGears) cases.push_back({bed, gear});
  }
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Terrain, Walls, ::testing::ValuesIn(all_cases()), [](const auto& one) {
  return std::string(one.param.bed.name) + one.param.gear.name;
});

// At a small angle the wall turns the robot along itself, and it scrapes on.
TEST(WallDrive, ARobotThatScrapesAlongAWallYaws) {
  for (const double side : {-1.0, 1.0}) {
    PlantOptions options = options_on(kBeds[0], kGears[0]);
    options.starts[0].attitude.heading = side * 15.0 * kDeg;
    options.starts[0].x_m = -0.35;
    options.starts[0].y_m = side * 0.4;
    Trial trial(kBeds[0], options);
    trial.run(2.5, 0.7, 0.7);
    EXPECT_GT(trial.deepest, 0.0);
    EXPECT_LT(std::abs(trial.heading()), 5.0 * kDeg);
    EXPECT_GT(trial.at().x(), -0.05);
    EXPECT_LT(trial.deepest, kDepth_m);
  }
}

// Straight into a wall the tracks slip at the speed that they had, and the motors carry the
// ground's friction: mu m g R more torque than the robot needs when it rolls.
TEST(WallDrive, AStoppedRobotSlipsItsTracks) {
  PlantOptions options = options_on(kBeds[0], kGears[0]);
  options.vehicle.track_friction = 0.4;
  options.vehicle.wall_friction = 0.0;
  Trial trial(kBeds[0], options);
  const Vehicle& vehicle = trial.plant.robot(0).vehicle();
  trial.run(1.5, 0.8, 0.8);
  const auto current = [&] { return vehicle.current_a(kLeft) + vehicle.current_a(kRight); };
  const double rolling_a = current();
  trial.run(5.0, 0.8, 0.8);
  EXPECT_LT(vehicle.chassis().velocity.norm(), 1e-3);
  EXPECT_GT(vehicle.track_speed_m_per_s(kLeft), 0.05);
  const GearMotor& motor = options.vehicle.motor;
  const double traction_n = 0.4 * vehicle.mass_kg() * kGravity_m_per_s2;
  EXPECT_NEAR((current() - rolling_a) * motor.torque_per_ampere(), traction_n * 0.03,
              0.05 * traction_n * 0.03);
}

// A stone floor round an avalanche: soil that is dug in a corner stays in the bed, to the unit, and
// piles up at the walls.
TEST(WallDrive, SoilPilesUpAtTheWalls) {
  Bed bed = kBeds[1];
  PlantOptions options = options_on(bed, kGears[0]);
  options.soil = soil_preset("viper");
  options.soil->slip_layer_m = 0.002;
  options.battery.begin_with(0.95);  // 8.1 V
  options.starts[0].attitude.heading = 45.0 * kDeg;
  options.starts[0].x_m = options.starts[0].y_m = 0.35;
  Trial trial(bed, options);
  const auto highest_at_walls = [&] {
    const HeightField& surface = trial.plant.terrain();
    Height highest = 0;
    for (int i = 0; i < surface.nx(); ++i) {
      highest =
          std::max({highest, surface.node(i, surface.ny() - 1), surface.node(surface.nx() - 1, i)});
    }
    return highest * kHeightUnit_m;
  };
  EXPECT_NEAR(highest_at_walls(), 0.1, 1e-6);
  for (int i = 0; i < 5; ++i) {
    trial.run(1.0, 1.0, 1.0);
    trial.run(2.0, -1.0, 1.0);
    EXPECT_EQ(trial.plant.volume_balance().error(), 0);
  }
  EXPECT_GT(highest_at_walls(), 0.1015);
  EXPECT_LT(trial.deepest, kDepth_m);
}

std::string refusal(double x, double y, double heading_deg, double size_m = 1.2) {
  PlantOptions options;
  options.starts[0].x_m = x;
  options.starts[0].y_m = y;
  options.starts[0].attitude.heading = heading_deg * kDeg;
  HeightField field = HeightField::flat(size_m, size_m / 8.0);
  field.add_walls();
  try {
    const Plant plant(std::move(field), rover5(), options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(WallDrive, AStartInAWallIsRefusedWithTheAllowedPlaces) {
  EXPECT_EQ(refusal(0.4, -0.4, 0.0), "");
  const std::string east = refusal(0.55, 0.0, 0.0);
  EXPECT_NE(east.find("[vehicle] x = 0.550 m, [vehicle] y = 0.000 m puts the robot into a wall"),
            std::string::npos)
      << east;
  // The range it names is right to the millimetre, and that of the other heading is the same,
  // turned.
  const auto limit = [](const std::string& text, const char* before) {
    const size_t at = text.find("..", text.find(before));
    return std::stod(text.substr(at + 2));
  };
  const double x = limit(east, "allowed are x ");
  const double y = limit(east, " and y ");
  EXPECT_EQ(refusal(x - 0.001, y - 0.001, 0.0), "");
  EXPECT_NE(refusal(x + 0.001, 0.0, 0.0), "");
  EXPECT_NE(refusal(0.0, y + 0.001, 0.0), "");
  EXPECT_GT(y, x) << "the robot is longer than wide";
  const std::string north = refusal(0.0, 0.55, 90.0);
  EXPECT_NEAR(limit(north, " and y "), x, 0.002);
  const std::string small = refusal(0.0, 0.0, 0.0, 0.2);
  EXPECT_NE(small.find("too small for a robot"), std::string::npos) << small;
}

TEST(WallDrive, ARobotLaidOnItsSideAtAWallIsInTheBed) {
  PlantOptions options = options_on(kBeds[0], kGears[0]);
  options.starts[0].attitude.heading = 90.0 * kDeg;
  options.starts[0].x_m = -0.48;
  Trial trial(kBeds[0], options);
  trial.plant.robot(0).lay_on_side();
  EXPECT_LT(depth_in_walls(trial.plant, trial.bounds), 1e-9);
  trial.run(2.0, 0.0, 0.0);
  EXPECT_LT(trial.deepest, kDepth_m);
  EXPECT_LT(trial.plant.robot(0).vehicle().chassis().velocity.norm(), 1e-3);
}

// Walls that nobody touches change no bit.
TEST(WallDrive, FarFromWallsNothingChanges) {
  for (const Bed& bed : {kBeds[0], kBeds[1]}) {
    const PlantOptions options = options_on(bed, kGears[0]);
    Trial between(bed, options);
    const int nodes = static_cast<int>(std::lround(bed.size_m / bed.spacing_m)) + 1;
    Plant open(HeightField::from_function(nodes, nodes, bed.spacing_m, false,
                                          [](double, double) { return 0.1; }),
               rover5(), options);
    between.run(1.0, 0.6, 0.4);
    for (int i = 0; i < 1000; ++i) testing::step_one(open, {0.6, 0.4});
    EXPECT_EQ(between.plant.robot(0).vehicle().chassis().pose.matrix(),
              open.robot(0).vehicle().chassis().pose.matrix());
  }
}

}  // namespace
}  // namespace screed::testing
