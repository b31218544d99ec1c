// Soil below the tracks of the surrogate world: bearing capacity, sinkage, conserved volume.
#include "nn/terrain/track_soil_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "host_sim/core/errors.h"
#include "host_sim/core/random.h"
#include "nn/terrain/bearing_capacity_trainer.h"
#include "nn/terrain/terrain_comparison.h"

namespace screed::nn {
namespace {

constexpr double kStep_m = 0.01;

HeightField bumps(int nodes, bool wrap) {
  return HeightField::from_function(nodes, nodes, 0.005, wrap, [](double x, double y) {
    return 0.004 * std::sin(9.0 * x) * std::cos(7.0 * y);
  });
}

/// Strides straight on along x, through the bed's middle.
std::vector<Stride> straight(double from_m, std::size_t strides) {
  std::vector<Stride> path;
  for (std::size_t i = 0; i < strides; ++i) {
    Stride stride;
    stride.x_m = from_m + static_cast<double>(i) * kStep_m;
    stride.forward_m = i == 0 ? 0.0 : kStep_m;
    stride.track_m = {stride.forward_m, stride.forward_m};
    path.push_back(stride);
  }
  return path;
}

/// Strides here and there.
std::vector<Stride> wandering(std::uint64_t seed, std::size_t strides) {
  WorldRandom random(seed, "wandering");
  std::vector<Stride> path;
  Stride stride;
  double turn = 0.0;
  for (std::size_t i = 0; i < strides; ++i) {
    if (i % 20 == 0) turn = random.uniform(-0.06, 0.06);
    stride.turn_rad = turn;
    stride.forward_m = random.uniform(-0.004, 0.012);
    stride.sideways_m = random.uniform(-0.001, 0.001);
    stride.yaw_rad += turn;
    const double c = std::cos(stride.yaw_rad);
    const double s = std::sin(stride.yaw_rad);
    stride.x_m += c * stride.forward_m - s * stride.sideways_m;
    stride.y_m += s * stride.forward_m + c * stride.sideways_m;
    stride.track_m = {stride.forward_m + 0.002, stride.forward_m};
    path.push_back(stride);
  }
  return path;
}

BearingCapacityNetwork any_weights(std::uint64_t seed) {
  BearingCapacityNetwork network(5, seed);
  WorldRandom random(seed, "weights");
  for (float& weight : network.weights()) weight = static_cast<float>(random.uniform(-3.0, 3.0));
  return network;
}

// A = the lower runs; what the round ends bear makes it a little less deep.
TEST(TrackSoilModel, AStandingRobotSinksAsBekkerSays) {
  for (const char* name : {"viper", "ding_2011", "soft"}) {
    SoilParameters soil = soil_preset(name);
    soil.exponent = 1.1;  // as published, of plates: the preset's is of a wheel
    const TrackGeometry tracks;
    TrackSoilModel ground(HeightField::flat(0.6, 0.005), soil, tracks);
    for (int i = 0; i < 3; ++i) ground.step_at(Stride{}, TrackPlane{});
    EXPECT_EQ(ground.sinkage().height_sum(), 0);
    for (int i = 0; i < 3; ++i) ground.step(Stride{}, nullptr);
    const double area = 4.0 * tracks.half_length_m * tracks.width_m;
    const double pressure = BearingCapacity{}.load * tracks.mass_kg * 9.80665 / area;
    const double bekker = soil.k_phi + soil.k_c / tracks.width_m;
    const double depth = std::pow(pressure / bekker, 1.0 / soil.exponent);
    const double stands = -ground.track_plane().height_m / depth;
    EXPECT_LT(stands, 1.05) << name;
    EXPECT_GT(stands, 0.8) << name;
    EXPECT_NEAR(ground.track_plane().forward, 0.0, 1e-5);
    EXPECT_NEAR(ground.track_plane().left, 0.0, 1e-5);
  }
}

TEST(TrackSoilModel, VolumeIsKeptToTheLastUnitWhateverTheWeights) {
  for (const bool wrap : {true, false}) {
    const HeightField bed = bumps(200, wrap);
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
      const BearingCapacityNetwork network = any_weights(seed);
      TrackSoilModel ground(bed, soil_preset("ding_2011"), TrackGeometry{});
      for (const Stride& stride : wandering(seed, 150)) ground.step(stride, &network);
      EXPECT_EQ(ground.surface().height_sum() + ground.in_transit(), bed.height_sum());
      EXPECT_GT(compare(bed, bed, ground.surface()).moved_cm3, 1.0);
    }
  }
}

TEST(TrackSoilModel, TheSameDriveGivesTheSameBits) {
  const HeightField bed = bumps(200, true);
  const BearingCapacityNetwork network = any_weights(4);
  TrackSoilModel a(bed, soil_preset("viper"), TrackGeometry{});
  TrackSoilModel b(bed, soil_preset("viper"), TrackGeometry{});
  for (const Stride& stride : wandering(1, 60)) {
    a.step(stride, &network);
    b.step(stride, &network);
  }
  EXPECT_EQ(compare(bed, a.surface(), b.surface()).error_mm, 0.0);
  EXPECT_EQ(compare(bed, a.surface(), b.surface()).outside_mm, 0.0);
}

TEST(TrackSoilModel, DrivingLeavesTwoRutsBetweenHeapsAndAgainPressesLittle) {
  const HeightField bed = HeightField::flat(2.0, 0.005);
  const std::vector<Stride> path = straight(-0.6, 121);
  TrackSoilModel ground(bed, soil_preset("ding_2011"), TrackGeometry{});
  for (const Stride& stride : path) ground.step(stride, nullptr);
  const HeightField once = ground.surface();
  EXPECT_EQ(count_ruts(bed, once, path).mean, 2.0);
  const double rut_mm = -once.at(0.0, 0.0975).height * 1e3;
  EXPECT_GT(rut_mm, 0.3);
  EXPECT_GT(once.at(0.0, 0.0975 + 0.0195).height, 0.0);
  EXPECT_NEAR(rut_mm, -once.at(0.0, -0.0975).height * 1e3, 0.01 * rut_mm);
  for (const Stride& stride : straight(-0.6, 121)) ground.step(stride, nullptr);
  EXPECT_LT(-ground.surface().at(0.0, 0.0975).height * 1e3, 1.4 * rut_mm);

  // What does not know of the first pass presses it as if it was fresh soil.
  TrackSoilModel with_sinkage(once, ground.sinkage(), soil_preset("ding_2011"), TrackGeometry{});
  TrackSoilModel without_sinkage(once, soil_preset("ding_2011"), TrackGeometry{});
  with_sinkage.step(Stride{}, nullptr);
  without_sinkage.step(Stride{}, nullptr);
  EXPECT_LT(compare(once, once, with_sinkage.surface()).moved_cm3,
            0.3 * compare(once, once, without_sinkage.surface()).moved_cm3);
}

TEST(TrackSoilModel, OnASlopeTheLowerTrackSinksDeeper) {
  const HeightField slope = HeightField::from_function(
      300, 200, 0.005, false, [](double /*x*/, double y) { return 0.1 * y; });
  TrackSoilModel ground(slope, soil_preset("soft"), TrackGeometry{});
  for (const Stride& stride : straight(-0.4, 61)) ground.step(stride, nullptr);
  const auto rut = [&](double y) { return 0.1 * y - ground.surface().at(0.15, y).height; };
  EXPECT_GT(rut(-0.0925), rut(0.1025) + 0.0001);
  EXPECT_NEAR(ground.track_plane().left, 0.1, 0.02);
}

TEST(BearingCapacityNetwork, BeginsAsTheClosedFormAndComesBackFromItsFile) {
  const BearingCapacityNetwork network(4, 1);
  const std::vector<float> inputs(BearingCapacityNetwork::kInputs, 0.7F);
  const BearingCapacity closed;
  const BearingCapacity evaluate = network.evaluate(inputs);
  EXPECT_DOUBLE_EQ(evaluate.equilibrium_stiffness, closed.equilibrium_stiffness);
  EXPECT_DOUBLE_EQ(evaluate.uplift, closed.uplift);
  EXPECT_DOUBLE_EQ(evaluate.relaxation, closed.relaxation);

  const auto file = std::filesystem::path(::testing::TempDir()) / "bearing.json";
  const BearingCapacityNetwork other = any_weights(7);
  other.write(file);
  EXPECT_EQ(BearingCapacityNetwork::read(file).weights(), other.weights());
  std::ofstream(file) << R"({"format": "screed-bearing-1", "hidden": 5, "weights": [1, 2]})";
  EXPECT_THROW(BearingCapacityNetwork::read(file), InputError);
}

// Ground pressed by a robot half as heavy again, which no weights know yet.
TEST(BearingCapacityTrainer, LearnsWhatTheClosedFormDoesNotKnow) {
  TrackGeometry heavy;
  heavy.mass_kg *= 1.5;
  DriveSegment segment{HeightField::flat(1.0, 0.01), HeightField::flat(1.0, 0.01),
                       HeightField::flat(1.0, 0.01), straight(-0.15, 30),
                       soil_preset("viper"),         TrackGeometry{}};
  TrackSoilModel real(segment.before, segment.soil, heavy);
  for (const Stride& stride : segment.path) real.step(stride, nullptr);
  segment.after = real.surface();
  segment.change_mm = compare(segment.before, segment.after, segment.before).error_mm;
  BearingCapacityNetwork network(2, 1);
  const double before = relative_error(segment, &network);
  EXPECT_EQ(before, relative_error(segment, nullptr));
  train(network, {{segment}}, 12, 1, nullptr);
  EXPECT_LT(relative_error(segment, &network), 0.5 * before);
}

}  // namespace
}  // namespace screed::nn
