// Networks of the terrain: soil that is moved is not lost, fluxes are learned, ruts are counted.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "host_sim/core/errors.h"
#include "host_sim/core/random.h"
#include "nn/terrain/drive_strides.h"
#include "nn/terrain/terrain_network.h"
#include "nn/terrain/terrain_trainer.h"
#include "tests/temp_folder.h"

namespace screed::nn {
namespace {

constexpr std::array<WheelPosition, 4> kWheels = {{{0.09, 0.1, 0.03, true},
                                                   {0.09, -0.1, 0.03, true},
                                                   {-0.09, 0.1, 0.03, false},
                                                   {-0.09, -0.1, 0.03, false}}};

HeightField bumps(bool wrap) {
  return HeightField::from_function(120, 100, 0.005, wrap, [](double x, double y) {
    return 0.004 * std::sin(40.0 * x) * std::cos(31.0 * y);
  });
}

TEST(FluxNetwork, VolumeIsKeptToTheLastUnitWhateverTheWeights) {
  for (const bool wrap : {false, true}) {
    HeightField ground = bumps(wrap);
    const std::int64_t before = ground.height_sum();
    const HeightField start = ground;
    FluxNetwork network(8, 3);
    WorldRandom random(1, "weights");
    for (float& weight : network.second()) weight = static_cast<float>(random.uniform(-2.0, 2.0));
    for (int i = 0; i < 40; ++i) {
      Stride stride;
      // Over the edges and corners too.
      stride.x_m = 0.02 * i - 0.4;
      stride.y_m = 0.3 * std::sin(0.4 * i);
      stride.yaw_rad = 0.3 * i;
      stride.forward_m = 0.005;
      stride.track_m = {0.006, 0.004};
      network.apply(ground, kWheels, stride);
      ASSERT_EQ(ground.height_sum(), before) << i;
    }
    EXPECT_GT(compare(start, ground, ground).true_change_mm, 0.1);
  }
}

TEST(FluxNetwork, MovedSoilLeavesOnePlaceAndComesToTheOther) {
  HeightField ground = HeightField::flat(1.0, 0.1);
  move_soil(ground, {0.0, 0.0}, {0.3, -0.2}, 1001);
  EXPECT_EQ(ground.node(5, 5), -1001);
  EXPECT_NEAR(ground.node(8, 3), 1001, 1);  // the rest is beside it: 0.3 is no node to the last bit
  move_soil(ground, {0.05, 0.05}, {-0.2, 0.0}, 1001);
  EXPECT_EQ(ground.height_sum(), 0);
  EXPECT_NEAR(ground.node(5, 5), -1001 - 250, 1);
}

TEST(FluxNetwork, FileKeepsIt) {
  TempFolder folder;
  FluxNetwork network(6, 5);
  network.write(folder.path() / "n.json");
  FluxNetwork read = FluxNetwork::read(folder.path() / "n.json").value();
  EXPECT_EQ(read.first(), network.first());
  EXPECT_EQ(read.second(), network.second());
  EXPECT_FALSE(FluxNetwork::read(folder.path() / "none.json").has_value());
  EXPECT_THROW(read_terrain_network(folder.path() / "none.json"), InputError);
}

TEST(FluxTrainer, LearnsTheFluxesOfAnotherNetwork) {
  FluxNetwork teacher(2, 11);
  for (float& weight : teacher.second()) weight *= 20.0F;
  FluxExamples examples;
  WorldRandom random(2, "examples");
  double squares = 0.0;
  for (int i = 0; i < 96; ++i) {
    std::vector<float> observation(FluxNetwork::kObservation);
    for (float& value : observation) value = static_cast<float>(random.uniform(-1.0, 1.0));
    std::vector<float> fluxes(FluxNetwork::kFluxes);
    teacher.evaluate(observation, fluxes);
    std::vector<float> changes(FluxNetwork::kCells);
    for (std::size_t flux = 0; flux < fluxes.size(); ++flux) {
      changes[cells_of(flux).from] -= fluxes[flux];
      changes[cells_of(flux).to] += fluxes[flux];
    }
    for (const float change : changes) {
      squares += static_cast<double>(change) * static_cast<double>(change);
    }
    examples.observations.insert(examples.observations.end(), observation.begin(),
                                 observation.end());
    examples.changes.insert(examples.changes.end(), changes.begin(), changes.end());
  }
  constexpr double kOutput_mm = FluxNetwork::kOutput_m * 1e3;
  const double untaught =
      squares / static_cast<double>(examples.changes.size()) * kOutput_mm * kOutput_mm;
  FluxNetwork pupil(6, 12);
  double last = 0.0;
  train(pupil, examples, 12, 1, [&](std::size_t, double mse) { last = mse; });
  EXPECT_LT(last, 0.5 * untaught);
}

TEST(TerrainComparison, CountsRuts) {
  const HeightField before = HeightField::from_function(
      200, 200, 0.005, false, [](double x, double y) { return 0.1 * x + 0.02 * y; });
  std::vector<Stride> way;
  for (int i = 0; i < 120; ++i) {
    Stride stride;
    stride.x_m = -0.3 + 0.005 * i;
    stride.forward_m = 0.005;
    way.push_back(stride);
  }
  const auto with_ruts = [&](const std::vector<double>& at_y) {
    HeightField after = before;
    for (int iy = 0; iy < after.ny(); ++iy) {
      for (const double rut : at_y) {
        if (std::abs(after.node_y(iy) - rut) > 0.012) continue;
        for (int ix = 0; ix < after.nx(); ++ix) {
          after.set_node(ix, iy, after.node(ix, iy) - static_cast<Height>(0.002 / kHeightUnit_m));
        }
      }
    }
    return count_ruts(before, after, way);
  };
  EXPECT_EQ(with_ruts({}).mean, 0.0);
  EXPECT_EQ(with_ruts({0.05}).mean, 1.0);
  EXPECT_EQ(with_ruts({0.1, -0.1}).mean, 2.0);
  EXPECT_EQ(with_ruts({0.12, 0.06, 0.0, -0.06, -0.12}).mean, 5.0);
  EXPECT_EQ(with_ruts({0.3}).mean, 0.0);  // not of this robot
}

TEST(TerrainComparison, VolumeAndError) {
  const HeightField before = HeightField::flat(1.0, 0.1);
  HeightField real = before;
  HeightField predicted = before;
  const auto millimetre = static_cast<Height>(0.001 / kHeightUnit_m);
  real.set_node(3, 3, -millimetre);
  predicted.set_node(3, 3, -2 * millimetre);
  predicted.set_node(7, 7, millimetre);
  const TerrainComparison c = compare(before, real, predicted);
  EXPECT_NEAR(c.true_change_mm, 1.0, 1e-3);
  EXPECT_NEAR(c.error_mm, 1.0, 1e-3);
  EXPECT_NEAR(c.outside_mm, 1.0 / std::sqrt(120.0), 1e-3);
  EXPECT_NEAR(c.touched_m2, 0.01, 1e-9);
  EXPECT_NEAR(c.moved_cm3, 20.0, 0.01);
  EXPECT_NEAR(c.volume_cm3, -10.0, 0.01);
  EXPECT_EQ(c.volume_units, -millimetre);
}

}  // namespace
}  // namespace screed::nn
