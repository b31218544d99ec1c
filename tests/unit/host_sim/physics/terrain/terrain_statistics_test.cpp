// Statistics of surfaces, and moved volumes.
#include <gtest/gtest.h>
#include <cmath>
#include <limits>
#include <numbers>

#include "host_sim/core/errors.h"
#include "host_sim/physics/terrain/terrain_statistics.h"

namespace screed {

namespace {

// Statistics of surfaces whose figures are known in closed form.

using std::numbers::pi;

double degrees(double gradient) {
  return std::atan(gradient) * 180.0 / pi;
}

TEST(TerrainStatisticsTest, RampHasOneSlope) {
  const HeightField ramp = HeightField::ramp(2.0, 0.02, 12.0);
  const TerrainStatistics s = terrain_statistics(ramp);
  constexpr double kRounding_deg = 5e-4;  // of heights to units, over 20 mm
  EXPECT_NEAR(s.mean_slope_deg, 12.0, kRounding_deg);
  EXPECT_NEAR(s.rms_slope_deg, 12.0, kRounding_deg);
  EXPECT_NEAR(s.p95_slope_deg, 12.0, kRounding_deg);
  EXPECT_NEAR(s.steepest_slope_deg, 12.0, kRounding_deg);
  const double rise = std::tan(12.0 * pi / 180.0);
  EXPECT_NEAR(s.lowest_m, -rise, kHeightUnit_m);
  EXPECT_NEAR(s.highest_m, rise, kHeightUnit_m);
  EXPECT_NEAR(s.mean_height_m, 0.0, kHeightUnit_m);
  // n evenly spaced values over a length L: variance L^2 (n + 1) / (12 (n - 1)).
  EXPECT_NEAR(s.height_deviation_m, 2.0 * rise * std::sqrt(102.0 / (12.0 * 100.0)), 1e-7);
  EXPECT_EQ(flatness(ramp, 11.99), 0.0);
  EXPECT_EQ(flatness(ramp, 12.01), 1.0);
}

TEST(TerrainStatisticsTest, TheSteepestSlopeIsThatOfACellsCentre) {
  // One corner raised: sqrt 2 at that corner, half of it in the middle of the cell.
  HeightField field(2, 2, 0.01, false);
  field.set_node(1, 1, 1 << 16);
  EXPECT_NEAR(terrain_statistics(field).steepest_slope_deg,
              degrees(std::sqrt(0.5) * (1 << 16) * kHeightUnit_m / 0.01), 1e-12);
}

TEST(TerrainStatisticsTest, ARampOfTheLimitIsFlat) {
  // Heights are rounded to the unit, so that half of such a ramp's cells are a hair steeper.
  for (const double limit : {0.5, 5.0, 12.0, 30.0, 60.0}) {
    for (const double spacing : {0.002, 0.005, 0.02}) {
      const auto flat = [&](double slope) {
        return flatness(HeightField::ramp(1.0, spacing, slope), limit);
      };
      EXPECT_EQ(flat(limit - 0.01), 1.0) << limit << ", " << spacing;
      EXPECT_EQ(flat(limit), 1.0) << limit << ", " << spacing;
      EXPECT_EQ(flat(limit + 0.01), 0.0) << limit << ", " << spacing;
    }
  }
  const double rise = std::tan(5.0 * pi / 180.0);
  const HeightField aslant = HeightField::from_function(
      101, 101, 0.01, false, [&](double x, double y) { return rise * (0.6 * x - 0.8 * y); });
  EXPECT_EQ(flatness(aslant, 5.0), 1.0);
  EXPECT_EQ(flatness(aslant, 4.99), 0.0);
}

TEST(TerrainStatisticsTest, LevelGroundIsFlat) {
  const HeightField flat = HeightField::flat(1.0, 0.1);
  EXPECT_EQ(flatness(flat, 0.0), 1.0);
  EXPECT_EQ(terrain_statistics(flat).steepest_slope_deg, 0.0);
  EXPECT_EQ(terrain_statistics(flat).height_deviation_m, 0.0);
}

TEST(TerrainStatisticsTest, CosineWave) {
  // z = c + a cos(2 pi x / L), periodic over L. At cell centres the bilinear slope is the chord's:
  // -G sin(2 pi x / L), with G = a 2 sin(pi / n) / spacing.
  constexpr int kNodes = 400;
  constexpr double kLength_m = 2.0;
  constexpr double kAmplitude_m = 0.03;
  constexpr double kSpacing_m = kLength_m / kNodes;
  const HeightField wave =
      HeightField::from_function(kNodes, 3, kSpacing_m, true, [](double x, double /*y*/) {
        return 0.5 + kAmplitude_m * std::cos(2.0 * pi * x / kLength_m);
      });
  const TerrainStatistics s = terrain_statistics(wave);
  EXPECT_NEAR(s.mean_height_m, 0.5, kHeightUnit_m);
  EXPECT_NEAR(s.height_deviation_m, kAmplitude_m / std::sqrt(2.0), kHeightUnit_m);
  EXPECT_NEAR(s.highest_m, 0.5 + kAmplitude_m, kHeightUnit_m);
  EXPECT_NEAR(s.lowest_m, 0.5 - kAmplitude_m, kHeightUnit_m);

  const double steepest = kAmplitude_m * 2.0 * std::sin(pi / kNodes) / kSpacing_m;
  constexpr double kRounding_deg = 1e-3;
  EXPECT_NEAR(s.steepest_slope_deg, degrees(steepest), kRounding_deg);
  // At small angles the slope in degrees is |sin| of the phase: mean 2 / pi, RMS 1 / sqrt 2, and
  // 95 % of the phases lie below sin(0.95 pi / 2). atan(g) = g (1 - g^2 / 3 ...), g <= 0.094.
  EXPECT_NEAR(s.mean_slope_deg / degrees(steepest), 2.0 / pi, 1e-3);
  EXPECT_NEAR(s.rms_slope_deg / degrees(steepest), std::sqrt(0.5), 1e-3);
  EXPECT_NEAR(s.p95_slope_deg / degrees(steepest), std::sin(0.95 * pi / 2.0), 1e-3);
  // |sin| <= 1/2 on a third of all phases.
  EXPECT_NEAR(flatness(wave, degrees(0.5 * steepest)), 1.0 / 3.0, 2.0 / kNodes);
}

TEST(TerrainStatisticsTest, P95IsANearestRank) {
  // 20 cells in a row with slopes 1, 2, ... 20 units a node: 95 % of them reach up to 19.
  HeightField field(21, 2, 0.001, false);
  Height height = 0;
  for (int ix = 0; ix < 21; ++ix) {
    height += ix;
    field.set_node(ix, 0, height);
    field.set_node(ix, 1, height);
  }
  const TerrainStatistics s = terrain_statistics(field);
  EXPECT_NEAR(s.p95_slope_deg, degrees(19 * kHeightUnit_m / 0.001), 1e-12);
  EXPECT_NEAR(s.steepest_slope_deg, degrees(20 * kHeightUnit_m / 0.001), 1e-12);
}

TEST(TerrainStatisticsTest, CellCentresSeeBothDirections) {
  // Two units east and one north over every cell: the gradient's length is sqrt 5.
  HeightField field(4, 5, 0.01, false);
  for (int iy = 0; iy < 5; ++iy) {
    for (int ix = 0; ix < 4; ++ix) field.set_node(ix, iy, 2000 * ix + 1000 * iy);
  }
  EXPECT_NEAR(terrain_statistics(field).mean_slope_deg,
              degrees(1000 * std::sqrt(5.0) * kHeightUnit_m / 0.01), 1e-12);
}

TEST(TerrainStatisticsTest, RefusesEpsilonOutOfRange) {
  const HeightField flat = HeightField::flat(1.0, 0.1);
  for (const double bad : {-0.1, 89.1, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(flatness(flat, bad), InputError);
  }
}

// Volumes of moved boxes.

constexpr double kSpacing_m = 0.01;

/// Raises nodes x..x+9, y..y+4 by `by_m`: 0.005 m2.
void raise_box(HeightField& field, int x, int y, double by_m) {
  for (int iy = y; iy < y + 5; ++iy) {
    for (int ix = x; ix < x + 10; ++ix)
      field.set_node(ix, iy,
                     field.node(ix, iy) + static_cast<Height>(std::lround(by_m / kHeightUnit_m)));
  }
}

TEST(TerrainChange, ABoxMovedAside) {
  HeightField before(80, 60, kSpacing_m, false);
  raise_box(before, 10, 10, 0.03);
  HeightField after(80, 60, kSpacing_m, false);
  raise_box(after, 40, 30, 0.03);
  const TerrainChange change = terrain_change(before, after);
  EXPECT_NEAR(change.cut_m3, 0.005 * 0.03, 1e-9);
  EXPECT_NEAR(change.fill_m3, 0.005 * 0.03, 1e-9);
  EXPECT_NEAR(change.moved_m3(), 0.005 * 0.03, 1e-9);
  EXPECT_NEAR(change.deepest_cut_m, 0.03, kHeightUnit_m);
  EXPECT_NEAR(change.deepest_fill_m, 0.03, kHeightUnit_m);
}

TEST(TerrainChange, WhatIsPressedDownIsCutAndNotMoved) {
  const HeightField before(80, 60, kSpacing_m, true);
  HeightField after = before;
  raise_box(after, 20, 20, -0.02);
  TerrainChange change = terrain_change(before, after);
  EXPECT_NEAR(change.cut_m3, 0.005 * 0.02, 1e-9);
  EXPECT_EQ(change.fill_m3, 0.0);
  EXPECT_EQ(change.moved_m3(), 0.0);
  EXPECT_NEAR(change.deepest_cut_m, 0.02, kHeightUnit_m);
  EXPECT_EQ(change.deepest_fill_m, 0.0);

  raise_box(after, 50, 20, 0.005);  // a quarter of it stands elsewhere
  change = terrain_change(before, after);
  EXPECT_NEAR(change.moved_m3(), 0.005 * 0.005, 1e-9);
  EXPECT_NEAR(change.deepest_fill_m, 0.005, kHeightUnit_m);
}

TEST(TerrainChange, NothingChangedIsZero) {
  const HeightField ramp = HeightField::ramp(1.0, 0.02, 10.0);
  const TerrainChange change = terrain_change(ramp, ramp);
  EXPECT_EQ(change.cut_m3, 0.0);
  EXPECT_EQ(change.fill_m3, 0.0);
  EXPECT_EQ(change.deepest_cut_m, 0.0);
  EXPECT_EQ(change.deepest_fill_m, 0.0);
}

TEST(TerrainChange, NeedsTheSameGrid) {
  const HeightField grid(20, 20, 0.1, false);
  for (const HeightField& other :
       {HeightField(21, 20, 0.1, false), HeightField(20, 21, 0.1, false),
        HeightField(20, 20, 0.2, false), HeightField(20, 20, 0.1, true)}) {
    EXPECT_THROW(terrain_change(grid, other), InputError);
  }
}

}  // namespace

}  // namespace screed
