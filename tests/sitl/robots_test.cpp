// Several robots on one bed, on every terrain: they meet, and none goes through another.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/physics/soil/soil_parameters.h"
#include "tests/sitl/test_drive.h"

namespace screed::testing {
namespace {

constexpr double kDepth_m = 0.004;  // in one another, at most

struct Bed {
  const char* name;
  bool soil;
  bool particles;
};
constexpr std::array<Bed, 3> kBeds = {
    {{"Rigid", false, false}, {"Soil", true, false}, {"Particles", false, true}}};

PlantOptions options_on(const Bed& bed) {
  PlantOptions options;
  if (bed.soil) options.soil = soil_preset("lete_sand");
  if (bed.particles) options.particles.emplace();
  return options;
}

HeightField ground(bool wrap, double size_m = 1.2) {
  const int nodes = static_cast<int>(std::lround(size_m / 0.02)) + (wrap ? 0 : 1);
  HeightField field =
      HeightField::from_function(nodes, nodes, 0.02, wrap, [](double, double) { return 0.05; });
  if (!wrap) field.add_walls();
  return field;
}

Eigen::Vector3d place(const RobotView& robot) {
  return robot.vehicle().chassis().pose.translation();
}

double deepest(Plant& plant) {
  RobotContact contact(0.0);
  double depth = 0.0;
  for (size_t i = 0; i < plant.robots(); ++i) {
    for (size_t j = i + 1; j < plant.robots(); ++j) {
      depth = std::max(depth, plant.robot(i).vehicle().depth_in(plant.robot(j).vehicle(),
                                                                Eigen::Vector3d::Zero(), contact));
    }
  }
  return depth;
}

class RobotsOnABed : public ::testing::TestWithParam<Bed> {};

TEST_P(RobotsOnABed, TwoThatDriveAtEachOtherMeetAndStayApart) {
  PlantOptions options = options_on(GetParam());
  options.starts[0].x_m = -0.25;
  options.starts = {options.starts[0], {0.25, 0.02, std::nullopt, {0.0, 0.0, std::numbers::pi}}};
  Plant plant(ground(false), rover5(), options);
  ASSERT_EQ(plant.robots(), 2U);
  const std::array<DutyRatio, 2> ahead = {{{0.9, 0.9}, {0.9, 0.9}}};
  double depth = 0.0;
  double nearest = 1.0;
  for (int i = 0; i < 4000; ++i) {
    plant.step(ahead);
    depth = std::max(depth, deepest(plant));
    nearest = std::min(nearest, (place(plant.robot(0)) - place(plant.robot(1))).norm());
  }
  EXPECT_GT(depth, 0.0) << "they have met";
  EXPECT_LT(depth, kDepth_m);
  // On gravel they turn until a track of each lies beside the other's: half a length and half a
  // hull.
  EXPECT_GT(nearest, GetParam().particles ? 0.207 - kDepth_m : 0.235)
      << "a robot's length is 0.244 m, its hull's 0.1705 m";
}

TEST_P(RobotsOnABed, AHitByAFasterOnePushesAStandingOneAlong) {
  PlantOptions options = options_on(GetParam());
  options.starts[0].x_m = -0.25;
  options.starts = {options.starts[0],
                    {0.1, 0.0, std::nullopt, {0.0, 0.0, 0.5 * std::numbers::pi}}};
  Plant plant(ground(false), rover5(), options);
  const double before = place(plant.robot(1)).x();
  const std::array<DutyRatio, 2> push = {{{1.0, 1.0}, {0.0, 0.0}}};
  for (int i = 0; i < 3000; ++i) {
    plant.step(push);
    ASSERT_LT(deepest(plant), kDepth_m) << i;
  }
  EXPECT_GT(place(plant.robot(1)).x() - before, -0.002);
  EXPECT_LT(place(plant.robot(0)).x(), place(plant.robot(1)).x());
}

INSTANTIATE_TEST_SUITE_P(Terrains, RobotsOnABed, ::testing::ValuesIn(kBeds),
                         [](const auto& tested) { return tested.param.name; });

/// In line, nearly, half a track and a whole track aside.
TEST(Robots, ThatDriveAtEachOtherStayApartHoweverTheirTracksMeet) {
  for (const bool tracks : {true, false}) {
    for (const double aside_m : {0.0, 0.001, 0.015, 0.03, 0.1}) {
      PlantOptions options;
      options.vehicle.tracks = tracks;
      options.starts[0].x_m = -0.2;
      options.starts = {options.starts[0],
                        {0.2, aside_m, std::nullopt, {0.0, 0.0, std::numbers::pi}}};
      Plant plant(ground(false), rover5(), options);
      const std::array<DutyRatio, 2> ahead = {{{0.9, 0.9}, {0.9, 0.9}}};
      double nearest = 1.0;
      double depth = 0.0;
      for (int i = 0; i < 1500; ++i) {
        plant.step(ahead);
        depth = std::max(depth, deepest(plant));
        nearest = std::min(nearest, (place(plant.robot(0)) - place(plant.robot(1))).norm());
      }
      // A robot is 0.244 m long and 0.225 m wide, its hull shorter: further aside one's track
      // stands between the other one's.
      EXPECT_GT(nearest, aside_m < 0.02 ? 0.24 : 0.21) << tracks << " " << aside_m;
      EXPECT_LT(depth, kDepth_m) << tracks << " " << aside_m;
      EXPECT_LT(nearest, 0.26) << "they have met";
    }
  }
}

TEST(Robots, FourThatDriveIntoOneAnotherStayApartWithEveryGear) {
  for (const bool tracks : {true, false}) {
    for (const TrackModel model : {TrackModel::kBelt, TrackModel::kChain}) {
      if (!tracks && model == TrackModel::kChain) continue;
      PlantOptions options;
      options.vehicle.tracks = tracks;
      options.vehicle.track_model = model;
      options.starts = {{-0.35, 0.0, std::nullopt, {0.0, 0.0, 0.0}},
                        {0.35, 0.0, std::nullopt, {0.0, 0.0, std::numbers::pi}},
                        {0.0, 0.35, std::nullopt, {0.0, 0.0, -0.5 * std::numbers::pi}},
                        {0.0, -0.35, std::nullopt, {0.0, 0.0, 0.5 * std::numbers::pi}}};
      Plant plant(ground(false), rover5(), options);
      const std::vector<DutyRatio> ahead(4, {0.9, 0.9});
      double depth = 0.0;
      for (int i = 0; i < 4000; ++i) {
        plant.step(ahead);
        depth = std::max(depth, deepest(plant));
      }
      EXPECT_GT(depth, 0.0);
      EXPECT_LT(depth, kDepth_m) << tracks << static_cast<int>(model);
    }
  }
}

TEST(Robots, OneFarAwayChangesNothing) {
  PlantOptions options;
  options.starts[0].x_m = -0.3;
  Plant alone(ground(false), rover5(), options);
  options.starts = {options.starts[0], {0.3, 0.0, std::nullopt, {0.0, 0.0, 0.0}}};
  Plant both(ground(false), rover5(), options);
  const std::array<DutyRatio, 2> turn = {{{0.5, -0.5}, {-0.4, 0.4}}};
  for (int i = 0; i < 1000; ++i) {
    alone.step(std::span(turn).first(1));
    both.step(turn);
  }
  EXPECT_EQ(place(alone.robot(0)), place(both.robot(0)));
  EXPECT_EQ(alone.robot(0).battery().energy_j, both.robot(0).battery().energy_j);
  EXPECT_NE(alone.robot(0).battery().energy_j, both.robot(1).battery().energy_j);
}

TEST(Robots, MeetRoundTheEdgeOfAWrappedBed) {
  PlantOptions options;
  options.starts = {{-0.3, 0.0, std::nullopt, {0.0, 0.0, std::numbers::pi}},
                    {0.3, 0.0, std::nullopt, {0.0, 0.0, 0.0}}};
  Plant plant(ground(true), rover5(), options);
  const std::array<DutyRatio, 2> ahead = {{{0.9, 0.9}, {0.9, 0.9}}};
  for (int i = 0; i < 4000; ++i) plant.step(ahead);
  const double apart =
      plant.robot(1).unwrapped_position().x() - plant.robot(0).unwrapped_position().x();
  EXPECT_LT(apart, 1.2 - 0.22) << "one bed further is the other one's copy";
  EXPECT_GT(apart, 0.7) << "they have driven";
}

TEST(Robots, MayNotStandInOneAnotherAtTheStart) {
  PlantOptions options;
  options.starts = {options.starts[0], {0.5, 0.0, std::nullopt, {}}, {0.1, 0.05, std::nullopt, {}}};
  try {
    const Plant plant(ground(false, 2.0), rover5(), options);
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("robots 0 and 2"), std::string::npos) << error.what();
  }
}

/// Steps are as long as one says while robots are apart, and short enough where they meet.
TEST(Robots, MeetAsCalmlyInLongSteps) {
  for (const double aside_m : {0.0, 0.015, 0.1}) {
    PlantOptions options = options_on({"Soil", true, false});
    options.physics_step_s = 0.005;  // as soil allows
    options.starts[0].x_m = -0.25;
    options.starts = {options.starts[0],
                      {0.25, aside_m, std::nullopt, {0.0, 0.0, std::numbers::pi}}};
    Plant plant(ground(false), rover5(), options);
    const std::array<DutyRatio, 2> ahead = {{{0.9, 0.9}, {0.9, 0.9}}};
    double depth = 0.0;
    for (int i = 0; i < 800; ++i) {
      plant.step(ahead);
      const double apart = (place(plant.robot(0)) - place(plant.robot(1))).norm();
      if (apart > 0.3) {
        EXPECT_EQ(plant.substeps(), 1) << apart;
      }
      const double now = deepest(plant);
      if (now > 0.0) {
        EXPECT_EQ(plant.substeps(), 3) << apart;
      }
      depth = std::max(depth, now);
    }
    EXPECT_GT(depth, 0.0) << "they have met";
    EXPECT_LT(depth, kDepth_m) << aside_m;
  }
}

}  // namespace
}  // namespace screed::testing
