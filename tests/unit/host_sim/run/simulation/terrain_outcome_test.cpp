// What a run did to its terrain, on soil and on particles.
#include "host_sim/run/simulation/outcome.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace screed {
namespace {

using std::numbers::pi;

Experiment on(const char* model) {
  Experiment experiment;
  experiment.map.model = model;
  return experiment;
}

/// Stones of 25 mm side by side on a slope: rows of half circles.
HeightField stones() {
  return HeightField::from_function(201, 201, 0.005, false, [](double x, double y) {
    const auto from_middle = [](double at) { return at - 0.025 * std::round(at / 0.025); };
    const double off = std::hypot(from_middle(x), from_middle(y));
    const double stone = std::sqrt(std::max(0.0, 0.0125 * 0.0125 - off * off));
    return stone + x * std::tan(3.0 * pi / 180.0);
  });
}

TEST(TerrainMeasure, SingleStonesAreNoSlopes) {
  Experiment experiment = on("particles");
  experiment.map.particle_radius_m = 0.0125;
  const TerrainMeasure measure(experiment);
  const HeightField bed = stones();
  EXPECT_GT(terrain_statistics(bed).mean_slope_deg, 30.0);
  EXPECT_LT(flatness(bed, 5.0), 0.2);

  const HeightField surface = measure.surface(bed);
  const TerrainStatistics heights = terrain_statistics(surface);
  EXPECT_NEAR(heights.mean_slope_deg, 3.0, 0.2);
  EXPECT_GT(flatness(surface, 5.0), 0.99);
  EXPECT_EQ(measure.outcome(surface, surface).after.flatness, flatness(surface, 5.0));
}

TEST(TerrainMeasure, TakesOtherTerrainAsItIs) {
  const HeightField bed = stones();
  for (const char* model : {"rigid", "scm"}) {
    const TerrainMeasure measure(on(model));
    EXPECT_EQ(terrain_change(bed, measure.surface(bed)).cut_m3, 0.0) << model;
    EXPECT_EQ(terrain_change(bed, measure.surface(bed)).fill_m3, 0.0) << model;
  }
}

TEST(TerrainMeasure, TheExperimentSaysWhatIsFlat) {
  Experiment experiment = on("scm");
  experiment.experiment.flatness_deg = 8.0;
  const HeightField ramp = HeightField::ramp(1.0, 0.01, 8.0);
  const HeightField steeper = HeightField::ramp(1.0, 0.01, 8.1);
  const TerrainOutcome outcome = TerrainMeasure(experiment).outcome(steeper, ramp);
  EXPECT_EQ(outcome.before.flatness, 0.0);
  EXPECT_EQ(outcome.after.flatness, 1.0);
}

TEST(TerrainMeasure, TellsBeforeFromAfter) {
  const HeightField before = HeightField::ramp(1.0, 0.01, 2.0);
  HeightField after = before;
  after.set_node(50, 50, after.node(50, 50) - 300000);
  after.set_node(60, 50, after.node(60, 50) + 200000);
  const TerrainOutcome outcome = TerrainMeasure(on("scm")).outcome(before, after);
  EXPECT_LT(outcome.before.heights.steepest_slope_deg, 2.1);
  EXPECT_GT(outcome.after.heights.steepest_slope_deg, 10.0);
  EXPECT_LT(outcome.before.robot_scale.roughness_m, 1e-6);
  EXPECT_GT(outcome.after.robot_scale.roughness_m, 1e-4);
  EXPECT_DOUBLE_EQ(outcome.change.deepest_cut_m, 300000 * kHeightUnit_m);
  EXPECT_DOUBLE_EQ(outcome.change.deepest_fill_m, 200000 * kHeightUnit_m);
}

}  // namespace
}  // namespace screed
