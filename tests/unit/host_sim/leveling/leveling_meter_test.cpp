// Points of a curve from known surfaces.
#include "host_sim/leveling/leveling_meter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace screed {
namespace {

/// A wave over a bed that repeats.
HeightField wave(double amplitude_m) {
  return HeightField::from_function(120, 60, 0.01, true, [&](double x, double /*y*/) {
    return amplitude_m * std::cos(2.0 * std::numbers::pi * x / 0.6);
  });
}

LevelingCost cost(double time_s, double energy_j) {
  LevelingCost cost;
  cost.time_s = time_s;
  cost.distance_m = 2.5;
  cost.energy_j = energy_j;
  cost.traversability = {0.125, 0.25, 0.375, 0.0625, 0.75, 0.5};
  return cost;
}

TEST(LevelingMeter, ProgressCountsFromTheFirstSurface) {
  LevelingMeter meter(5.0);
  const LevelingPoint start = meter.measure(wave(0.02), cost(0.0, 0.0), true);
  EXPECT_EQ(start.progress, 0.0);
  EXPECT_TRUE(std::isnan(start.transport_per_joule)) << "no energy was spent yet";
  const LevelingPoint later = meter.measure(wave(0.015), cost(60.0, 200.0), true);
  EXPECT_NEAR(later.progress, 0.25, 1e-5);
  EXPECT_DOUBLE_EQ(later.transport_per_joule, (start.transport - later.transport) / 200.0);
  EXPECT_NEAR(later.relief / start.relief, 0.75, 1e-5);
  EXPECT_NEAR(later.height_deviation, 0.015 / std::sqrt(2.0), 1e-7);
  const LevelingPoint worse = meter.measure(wave(0.03), cost(90.0, 300.0), true);
  EXPECT_NEAR(worse.progress, -0.5, 1e-5);
  EXPECT_LT(worse.transport_per_joule, 0.0);
}

TEST(LevelingMeter, WithoutTransportTheRestIsThere) {
  LevelingMeter meter(5.0);
  const LevelingPoint point = meter.measure(wave(0.02), cost(30.0, 100.0), false);
  EXPECT_TRUE(std::isnan(point.transport));
  EXPECT_TRUE(std::isnan(point.transport_error));
  EXPECT_TRUE(std::isnan(point.transport_squared));
  EXPECT_TRUE(std::isnan(point.progress));
  EXPECT_EQ(point.time, 30.0);
  EXPECT_EQ(point.distance, 2.5);
  EXPECT_EQ(point.energy, 100.0);
  EXPECT_EQ(point.stuck, 0.125);
  EXPECT_EQ(point.tilted, 0.25);
  EXPECT_EQ(point.off_site, 0.375);
  EXPECT_EQ(point.returning, 0.0625);
  EXPECT_EQ(point.visited, 0.75);
  EXPECT_EQ(point.slip, 0.5);
  EXPECT_GT(point.relief, 0.01);
  EXPECT_GT(point.robot_scale_flatness, point.flatness);
}

TEST(LevelingMeter, FromLevelGroundThereIsNoProgress) {
  LevelingMeter meter(5.0);
  const LevelingPoint start = meter.measure(HeightField::flat(1.0, 0.1), cost(0.0, 0.0), true);
  EXPECT_EQ(start.transport, 0.0);
  EXPECT_TRUE(std::isnan(start.progress));
}

}  // namespace
}  // namespace screed
