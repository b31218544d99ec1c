// Robots whose motion is predicted: kinematics against closed forms, and many at once against one
// by one.
#include "nn/surrogate/surrogate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "host_sim/core/errors.h"
#include "host_sim/core/random.h"
#include "nn/data/features.h"
#include "tests/unit/nn/surrogate/linear_model.h"

namespace screed::nn {
namespace {

constexpr double kHalf = 1.0 / 65536.0;  // of an activation's step

HeightField hills() {
  return HeightField::from_function(64, 64, 0.04, true, [](double x, double y) {
    return 0.02 * std::sin(x * 2.0 * std::numbers::pi / 2.56) *
           std::cos(y * 4.0 * std::numbers::pi / 2.56);
  });
}

Model random_model() {
  WorldRandom random(5, "random model");
  std::vector<ModelChannel> inputs;
  for (const MotionSignalInfo& info : motion_signals()) inputs.push_back(channel(info.name, 0.3));
  std::vector<FloatLayer> layers;
  const std::vector<std::size_t> widths = {kMotionSignals, 12, 3};
  for (std::size_t i = 1; i < widths.size(); ++i) {
    FloatLayer layer{widths[i - 1], widths[i], i == 2, {}, {}};
    for (std::size_t n = 0; n < layer.inputs * layer.outputs; ++n) {
      layer.weights.push_back(random.uniform(-0.7, 0.7));
    }
    for (std::size_t n = 0; n < layer.outputs; ++n) layer.bias.push_back(random.uniform(-0.3, 0.3));
    layers.push_back(layer);
  }
  Model model;
  model.name = "random";
  model.networks.push_back({inputs,
                            {channel("forward", 0.002, "forward@1"), channel("sideways", 0.001),
                             channel("delta_theta", 0.02, "delta_theta@1")},
                            quantise(layers),
                            layers,
                            {}});
  return model;
}

TEST(Surrogate, MeasuresTheInclinationOfAPlane) {
  const double rise = std::tan(7.0 * std::numbers::pi / 180.0);
  const HeightField ramp = HeightField::ramp(4.0, 0.05, 7.0);
  const SupportGeometry geometry;
  for (const double heading : {0.0, 0.5, 2.0, -2.5}) {
    const Support support =
        support_at(ramp, geometry, 0.31, -0.2, std::cos(heading), std::sin(heading));
    EXPECT_NEAR(support.pitch, std::atan(rise * std::cos(heading)), 1e-6);
    EXPECT_NEAR(support.roll, std::atan(-rise * std::sin(heading)), 1e-6);
    EXPECT_NEAR(support.height_m, 0.31 * rise, 1e-6);
  }
}

TEST(Signals, AreFoundByTheirNamesAndNoOthersAre) {
  for (const MotionSignalInfo& info : motion_signals()) {
    ASSERT_TRUE(motion_signal_named(info.name).has_value()) << info.name;
    EXPECT_EQ(*motion_signal_named(info.name), info.signal);
  }
  EXPECT_FALSE(motion_signal_named("wheel").has_value());
}

TEST(Surrogate, WithoutSlipDrivesTheArcOfItsTracks) {
  const HeightField ground = HeightField::flat(10.0, 0.1);
  Surrogate robot(skid_kinematics(1.0, 0.127), SupportGeometry{}, 1);
  robot.set_pose(0, {1.0, 2.0, 0.7});
  const double left = 0.1;
  const double right = 0.14;
  constexpr int kFrames = 500;
  for (int i = 0; i < kFrames; ++i) robot.step(ground, {&left, 1}, {&right, 1});
  // Chords of a circle.
  const double chord = 0.0012;
  const double turn = 0.04 / 0.127 * 0.01;
  const double way = chord * std::sin(kFrames * turn / 2.0) / std::sin(turn / 2.0);
  const double towards = 0.7 + kFrames * turn / 2.0;
  EXPECT_NEAR(robot.pose(0).x_m, 1.0 + way * std::cos(towards), 1e-12);
  EXPECT_NEAR(robot.pose(0).y_m, 2.0 + way * std::sin(towards), 1e-12);
  EXPECT_NEAR(robot.pose(0).heading_rad, 0.7 + kFrames * turn, 1e-12);
}

TEST(Surrogate, TakesDisplacementsAndTurnFromTheNetwork) {
  // forward = 0.008 m/s of 0.5 (left + right), sideways = 0.1 roll a frame, turn grows by 0.001.
  const Model model =
      linear_model({channel("track_left", 0.3), channel("track_right", 0.3), channel("roll", 0.2)},
                   {channel("forward", 0.01), channel("sideways", 0.01),
                    channel("delta_theta", 0.01, "delta_theta@1")},
                   {0.12, 0.12, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0}, {0.0, 0.0, 0.1});
  const HeightField ramp = HeightField::ramp(4.0, 0.05, 5.0);
  Surrogate robot(model, SupportGeometry{}, 1);
  robot.set_pose(0, {0.0, 0.0, -std::numbers::pi / 2.0});  // the slope rises to its left
  const double left = 0.1;
  const double right = 0.2;
  robot.step(ramp, {&left, 1}, {&right, 1});
  const double roll = 5.0 * std::numbers::pi / 180.0;
  EXPECT_NEAR(robot.roll(0), roll, 1e-6);
  EXPECT_NEAR(robot.motion(0).forward_m, 0.0012, 0.01 * 4 * kHalf);
  EXPECT_NEAR(robot.motion(0).sideways_m, 0.025 * roll, 0.01 * 4 * kHalf);
  EXPECT_NEAR(robot.motion(0).turn_rad, 0.001, 0.01 * 4 * kHalf);
  robot.step(ramp, {&left, 1}, {&right, 1});
  EXPECT_NEAR(robot.motion(0).turn_rad, 0.002, 0.01 * 8 * kHalf);
}

TEST(Surrogate, GivesADistanceTheSignOfTheTracks) {
  const Model model =
      linear_model({channel("v_left", 10.0)}, {channel("v", 0.01), channel("delta_theta", 0.01)},
                   {0.0, 0.0}, {0.25, 0.0});
  const HeightField ground = HeightField::flat(4.0, 0.1);
  Surrogate robot(model, SupportGeometry{}, 1);
  const double back = -0.1;
  const double ahead = 0.1;
  robot.step(ground, {&back, 1}, {&back, 1});
  EXPECT_NEAR(robot.motion(0).forward_m, -0.0025, 1e-6);
  robot.step(ground, {&ahead, 1}, {&ahead, 1});
  EXPECT_NEAR(robot.motion(0).forward_m, 0.0025, 1e-6);
}

TEST(Surrogate, ASignOfTracksThatTurnAgainstEachOtherIsNoJump) {
  const Model model =
      linear_model({channel("v_left", 10.0)}, {channel("v", 0.01), channel("delta_theta", 0.01)},
                   {0.0, 0.0}, {0.25, 0.0});
  const HeightField ground = HeightField::flat(4.0, 0.1);
  for (const Surrogate::Arithmetic arithmetic :
       {Surrogate::Arithmetic::kInteger, Surrogate::Arithmetic::kFloat}) {
    Surrogate robot(model, SupportGeometry{}, 1, arithmetic);
    const auto way = [&](double left, double right) {
      robot.step(ground, {&left, 1}, {&right, 1});
      return robot.motion(0).forward_m;
    };
    EXPECT_NEAR(way(-0.1, 0.1 + 1e-9), way(-0.1, 0.1 - 1e-9), 1e-9);
    EXPECT_NEAR(way(-0.1, 0.12), 0.5 * 0.0025, 1e-6);
    EXPECT_NEAR(way(0.1, -0.12), -0.5 * 0.0025, 1e-6);
    EXPECT_NEAR(way(-0.1, 0.15), 0.0025, 1e-6);
  }
}

TEST(Surrogate, DoesNotRunAwayWhenTheNetworkGoesOnAdding) {
  const Model model =
      linear_model({channel("forward@1", 0.005)},
                   {channel("forward", 0.001, "forward@1"), channel("delta_theta", 0.01)},
                   {0.0, 0.0}, {0.9, 0.0});
  const HeightField ground = HeightField::flat(4.0, 0.1);
  const double slow = 0.01;
  for (const Surrogate::Arithmetic arithmetic :
       {Surrogate::Arithmetic::kInteger, Surrogate::Arithmetic::kFloat}) {
    Surrogate robot(model, SupportGeometry{}, 1, arithmetic);
    for (int frame = 0; frame < 50; ++frame) robot.step(ground, {&slow, 1}, {&slow, 1});
    EXPECT_EQ(robot.motion(0).forward_m, 0.005);
  }
}

TEST(Surrogate, WhatIsNotDrivenStandsWhateverTheNetworkSays) {
  const Model model = linear_model(
      {channel("pitch", 1.0)},
      {channel("forward", 0.001), channel("sideways", 0.001), channel("delta_theta", 0.01)},
      {0.0, 0.0, 0.0}, {0.5, 0.5, 0.5});
  const HeightField ground = HeightField::ramp(4.0, 0.1, 8.0);
  Surrogate robots(model, SupportGeometry{}, 2);
  const std::vector<double> left = {0.0, 0.0};
  const std::vector<double> right = {0.0, -0.002};
  for (int frame = 0; frame < 10; ++frame) robots.step(ground, left, right);
  EXPECT_EQ(robots.pose(0).x_m, 0.0);
  EXPECT_EQ(robots.pose(0).y_m, 0.0);
  EXPECT_EQ(robots.pose(0).heading_rad, 0.0);
  EXPECT_EQ(robots.motion(0).turn_rad, 0.0);
  EXPECT_NEAR(robots.pose(1).heading_rad, 10 * 0.005, 1e-5) << "one track turns";
}

TEST(Surrogate, ManyRobotsGiveTheBitsOfOne) {
  const Model model = random_model();
  const HeightField ground = hills();
  constexpr std::size_t kRobots = 67;  // blocks of 16 and 32, and a rest
  constexpr int kFrames = 40;
  WorldRandom random(9, "robots");
  std::vector<PlanarPose> places;
  std::vector<double> left;
  std::vector<double> right;
  for (std::size_t i = 0; i < kRobots; ++i) {
    places.push_back(
        {random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0), random.uniform(-7.0, 7.0)});
    left.push_back(random.uniform(-0.25, 0.25));
    right.push_back(random.uniform(-0.25, 0.25));
  }
  std::vector<PlanarPose> alone;
  for (std::size_t i = 0; i < kRobots; ++i) {
    Surrogate robot(model, SupportGeometry{}, 1, Surrogate::Arithmetic::kInteger,
                    InstructionSet::kBaseline);
    robot.set_pose(0, places[i]);
    for (int frame = 0; frame < kFrames; ++frame) {
      robot.step(ground, {&left[i], 1}, {&right[i], 1});
    }
    alone.push_back(robot.pose(0));
  }
  for (const InstructionSet kernel : instruction_sets()) {
    Surrogate robots(model, SupportGeometry{}, kRobots, Surrogate::Arithmetic::kInteger, kernel);
    for (std::size_t i = 0; i < kRobots; ++i) {
      robots.set_pose(i, places[i]);
    }
    for (int frame = 0; frame < kFrames; ++frame) robots.step(ground, left, right);
    for (std::size_t i = 0; i < kRobots; ++i) {
      ASSERT_EQ(robots.pose(i).x_m, alone[i].x_m) << name_of(kernel) << " " << i;
      ASSERT_EQ(robots.pose(i).y_m, alone[i].y_m);
      ASSERT_EQ(robots.pose(i).heading_rad, alone[i].heading_rad);
    }
  }
}

/// forward = 0.01 times the normalised speed of the left track.
Model staged_model(std::vector<PreprocessingStage> stages) {
  Model model = linear_model({channel("track_left", 0.2)},
                             {channel("forward", 0.01), channel("delta_theta", 0.01)}, {0.5, 0.0},
                             {0.0, 0.0});
  for (PreprocessingStage& stage : stages) stage.run_time = true;
  model.stages = std::move(stages);
  return model;
}

/// The normalised input that reached the network, at each of these speeds.
std::vector<double> felt(const Model& model, const std::vector<double>& speeds,
                         Surrogate::Arithmetic arithmetic = Surrogate::Arithmetic::kInteger) {
  const HeightField ground = HeightField::flat(4.0, 0.1);
  Surrogate robot(model, SupportGeometry{}, 1, arithmetic);
  const double driven = 0.1;  // the right track, which the network does not see
  std::vector<double> felt;
  for (const double speed : speeds) {
    robot.step(ground, {&speed, 1}, {&driven, 1});
    felt.push_back(robot.motion(0).forward_m / 0.005);
  }
  return felt;
}

void expect_felt(const Model& model, const std::vector<double>& speeds,
                 const std::vector<double>& wanted) {
  for (const Surrogate::Arithmetic arithmetic :
       {Surrogate::Arithmetic::kInteger, Surrogate::Arithmetic::kFloat}) {
    const std::vector<double> got = felt(model, speeds, arithmetic);
    for (std::size_t i = 0; i < wanted.size(); ++i) EXPECT_NEAR(got[i], wanted[i], 2e-4) << i;
  }
}

TEST(Surrogate, AppliesTheStagesOfRunTimeToItsInputsInTheirOrder) {
  const PreprocessingStage mean{"mean", "", 0.0, 0.0, 3.0, false};
  const PreprocessingStage exponential{"exponential", "", 0.0, 0.0, 0.25, false};
  const PreprocessingStage quantise{"quantise", "", 0.0, 0.0, 0.2, false};
  const std::vector<double> speeds = {0.1, 0.04, 0.16, 0.0, 0.0};  // 0.5, 0.2, 0.8, 0, 0
  expect_felt(staged_model({mean}), speeds, {0.5, 0.35, 0.5, 1.0 / 3.0, 0.8 / 3.0});
  expect_felt(staged_model({exponential}), speeds, {0.5, 0.425, 0.51875, 0.3890625, 0.291796875});
  expect_felt(staged_model({{"normalise", "", 0.0, 0.0, 0.0, false}, mean, quantise}), speeds,
              {0.4, 0.2, 0.4, 0.2, 0.2});
  expect_felt(staged_model({quantise, mean}), speeds, {0.4, 0.3, 1.4 / 3.0, 1.0 / 3.0, 0.8 / 3.0});
  EXPECT_THROW(felt(staged_model({{"remove_far", "v", 0.0, 1.0, 0.0, false}}), speeds), InputError);
}

TEST(Surrogate, ProductsOfWheelsAndSlopeEqualTheFeatures) {
  SimFrame frame;
  frame.pitch = 0.2;
  frame.roll = -0.1;
  const double left = -0.12;
  const double right = 0.06;
  frame.v_left = left / SupportGeometry{}.wheel_radius_m;
  frame.v_right = right / SupportGeometry{}.wheel_radius_m;
  for (const char* name : {"speed", "spin", "climb", "lean", "slide", "pivot"}) {
    const Model model =
        linear_model({channel(name, 10.0)}, {channel("forward", 10.0), channel("delta_theta", 1.0)},
                     {1.0, 0.0}, {0.0, 0.0});
    Surrogate robot(model, SupportGeometry{}, 1);
    robot.step_on_slope(frame.pitch, frame.roll, {&left, 1}, {&right, 1});
    EXPECT_NEAR(robot.motion(0).forward_m, NamedFeature(name).value(FrameWindow({&frame, 1})),
                10.0 * 4 * kHalf)
        << name;
  }
}

TEST(Surrogate, StagesThatAreNotOfRunTimeChangeNothing) {
  Model model = staged_model({{"mean", "", 0.0, 0.0, 3.0, false}});
  model.stages[0].run_time = false;
  expect_felt(model, {0.1, 0.04}, {0.5, 0.2});
}

TEST(Surrogate, SmoothsEveryRobotByItself) {
  const Model model = staged_model(
      {{"exponential", "", 0.0, 0.0, 0.25, false}, {"mean", "", 0.0, 0.0, 4.0, false}});
  const HeightField ground = HeightField::flat(4.0, 0.1);
  constexpr std::size_t kRobots = 5;
  Surrogate together(model, SupportGeometry{}, kRobots);
  std::vector<Surrogate> alone(kRobots, Surrogate(model, SupportGeometry{}, 1));
  WorldRandom random(3, "speeds");
  for (int frame = 0; frame < 20; ++frame) {
    std::vector<double> speeds;
    for (std::size_t i = 0; i < kRobots; ++i) speeds.push_back(random.uniform(-0.2, 0.2));
    if (frame == 10) {  // put elsewhere, it begins anew
      together.set_pose(2, {1.0, 0.0, 0.0});
      alone[2] = Surrogate(model, SupportGeometry{}, 1);
      alone[2].set_pose(0, {1.0, 0.0, 0.0});
    }
    together.step(ground, speeds, speeds);
    for (std::size_t i = 0; i < kRobots; ++i) {
      alone[i].step(ground, {&speeds[i], 1}, {&speeds[i], 1});
      ASSERT_EQ(together.motion(i).forward_m, alone[i].motion(0).forward_m) << frame << " " << i;
    }
  }
}

TEST(Surrogate, IntegersFollowTheFloatingNetwork) {
  const Model model = random_model();
  const HeightField ground = hills();
  Surrogate integers(model, SupportGeometry{}, 1);
  Surrogate floating(model, SupportGeometry{}, 1, Surrogate::Arithmetic::kFloat);
  const double left = 0.12;
  const double right = 0.1;
  for (int frame = 0; frame < 5; ++frame) {
    integers.step(ground, {&left, 1}, {&right, 1});
    floating.step(ground, {&left, 1}, {&right, 1});
    EXPECT_NEAR(integers.motion(0).forward_m, floating.motion(0).forward_m, 1e-5);
    EXPECT_NEAR(integers.motion(0).turn_rad, floating.motion(0).turn_rad, 1e-4);
  }
}

TEST(Surrogate, RefusesWhatItDoesNotKnow) {
  const SupportGeometry geometry;
  const auto make = [&](const Model& model, Surrogate::Arithmetic arithmetic) {
    return Surrogate(model, geometry, 1, arithmetic);
  };
  const Model input =
      linear_model({channel("colour", 1.0)}, {channel("forward", 1.0), channel("delta_theta", 1.0)},
                   {0.0, 0.0}, {0.0, 0.0});
  EXPECT_THROW(make(input, Surrogate::Arithmetic::kInteger), InputError);
  const Model output =
      linear_model({channel("pitch", 1.0)}, {channel("delta_x", 1.0)}, {0.0}, {0.0});
  EXPECT_THROW(make(output, Surrogate::Arithmetic::kInteger), InputError);
  const Model half = linear_model({channel("pitch", 1.0)}, {channel("forward", 1.0)}, {0.0}, {0.0});
  EXPECT_THROW(make(half, Surrogate::Arithmetic::kInteger), InputError);
  Model integers =
      linear_model({channel("pitch", 1.0)}, {channel("forward", 1.0), channel("delta_theta", 1.0)},
                   {0.0, 0.0}, {0.0, 0.0});
  integers.networks[0].trained.clear();
  EXPECT_NO_THROW(make(integers, Surrogate::Arithmetic::kInteger));
  EXPECT_THROW(make(integers, Surrogate::Arithmetic::kFloat), InputError);
}

}  // namespace
}  // namespace screed::nn
