// Made-up relief against closed forms: the RMS asked for, a power law's slope, the volume of cones,
// a trench whose banks hold what was dug out.
#include "host_sim/physics/terrain/relief.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "host_sim/core/errors.h"

namespace screed {
namespace {

double mean_of(const HeightField& field) {
  return static_cast<double>(field.height_sum()) * kHeightUnit_m / (field.nx() * field.ny());
}

double rms_of(const HeightField& field) {
  const double mean = mean_of(field);
  double sum = 0.0;
  for (int iy = 0; iy < field.ny(); ++iy) {
    for (int ix = 0; ix < field.nx(); ++ix) {
      const double height = field.node(ix, iy) * kHeightUnit_m - mean;
      sum += height * height;
    }
  }
  return std::sqrt(sum / (field.nx() * field.ny()));
}

/// Power of a wave along x, mean over all rows of a field with wrap.
double power_along_x(const HeightField& field, int wave) {
  const int nx = field.nx();
  std::vector<double> cosines;
  std::vector<double> sines;
  for (int ix = 0; ix < nx; ++ix) {
    const double angle = 2.0 * std::numbers::pi * wave * ix / nx;
    cosines.push_back(kHeightUnit_m * std::cos(angle));
    sines.push_back(kHeightUnit_m * std::sin(angle));
  }
  double power = 0.0;
  for (int iy = 0; iy < field.ny(); ++iy) {
    const Height* const row = field.heights() + iy * nx;
    const double cosine = std::inner_product(row, row + nx, cosines.begin(), 0.0);
    const double sine = std::inner_product(row, row + nx, sines.begin(), 0.0);
    power += cosine * cosine + sine * sine;
  }
  return power / field.ny();
}

TEST(Relief, HasTheRmsAskedForAndIsRepeatedBySeed) {
  const ReliefOptions options{.seed = 7, .rms_m = 0.012};
  HeightField field = HeightField::flat(1.5, 0.01, true);
  add_relief(options, field);
  EXPECT_NEAR(rms_of(field), 0.012, 1e-7);
  EXPECT_NEAR(mean_of(field), 0.0, 1e-7);
  HeightField again = HeightField::flat(1.5, 0.01, true);
  add_relief(options, again);
  EXPECT_TRUE(
      std::equal(field.heights(), field.heights() + field.nx() * field.ny(), again.heights()));
  HeightField other = HeightField::flat(1.5, 0.01, true);
  add_relief({.seed = 8, .rms_m = 0.012}, other);
  EXPECT_FALSE(
      std::equal(field.heights(), field.heights() + field.nx() * field.ny(), other.heights()));
}

TEST(Relief, FollowsThePowerLawInItsBandAlone) {
  // PSD of a profile ~ number^-w: from waves 4 to 16 of the bed the power falls by 4^w.
  for (const double exponent : {1.0, 2.0, 3.0}) {
    double low = 0.0;
    double high = 0.0;
    double beyond = 0.0;
    for (uint64_t seed = 1; seed <= 12; ++seed) {
      HeightField field = HeightField::flat(2.0, 2.0 / 128, true);
      add_relief({.seed = seed,
                  .rms_m = 0.02,
                  .exponent = exponent,
                  .longest_wave_m = 2.0,
                  .shortest_wave_m = 2.0 / 50},
                 field);
      low += power_along_x(field, 4);
      high += power_along_x(field, 16);
      beyond += power_along_x(field, 56);
    }
    // A profile adds up all waves across it, so near the ends of the band the law bends: 15 %.
    EXPECT_NEAR(std::log(low / high) / std::log(4.0), exponent, 0.15 * exponent + 0.15) << exponent;
    EXPECT_LT(beyond, 1e-6 * high);
  }
}

TEST(Relief, WavesReachTheSameHeightsOnAFinerGrid) {
  HeightField coarse = HeightField::flat(1.5, 0.02);
  HeightField fine = HeightField::flat(1.5, 0.005);
  const ReliefOptions options{.seed = 3, .rms_m = 0.01};
  add_relief(options, coarse);
  add_relief(options, fine);
  double worst = 0.0;
  for (int i = 0; i < coarse.nx(); ++i) {
    const double x = coarse.node_x(i);
    worst = std::max(worst, std::abs(coarse.at(x, 0.31).height - fine.at(x, 0.31).height));
  }
  EXPECT_LT(worst, 0.0008);
}

TEST(Relief, MoundsHaveTheVolumeOfCones) {
  HeightField field = HeightField::flat(2.0, 0.004, true);
  add_relief({.seed = 5, .mounds = 1, .mound_height_m = 0.1, .mound_slope_deg = 30.0}, field);
  double top = 0.0;
  for (int iy = 0; iy < field.ny(); ++iy)
    for (int ix = 0; ix < field.nx(); ++ix) top = std::max(top, field.node(ix, iy) * kHeightUnit_m);
  EXPECT_GT(top, 0.049);
  EXPECT_LE(top, 0.1);
  const double volume = static_cast<double>(field.height_sum()) * kHeightUnit_m * 0.004 * 0.004;
  const double radius = top / std::tan(std::numbers::pi / 6.0);
  EXPECT_NEAR(volume, std::numbers::pi * radius * radius * top / 3.0, 0.04 * volume);
  // At the very top the steepest falls along both axes come together.
  const double slope = std::tan(std::numbers::pi / 6.0);
  EXPECT_GT(field.steepest_gradient(), 0.99 * slope);
  EXPECT_LE(field.steepest_gradient(), std::numbers::sqrt2 * slope);
}

TEST(Relief, ATrenchHasItsDepthAndBanksOfWhatWasDugOut) {
  HeightField field = HeightField::flat(3.0, 0.01);
  add_relief({.seed = 11, .trench_depth_m = 0.08, .trench_width_m = 0.2, .trench_slope_deg = 25.0},
             field);
  double lowest = 0.0;
  double highest = 0.0;
  double dug = 0.0;
  double banks = 0.0;
  for (int iy = 0; iy < field.ny(); ++iy) {
    for (int ix = 0; ix < field.nx(); ++ix) {
      const double height = field.node(ix, iy) * kHeightUnit_m;
      lowest = std::min(lowest, height);
      highest = std::max(highest, height);
      (height < 0.0 ? dug : banks) += std::abs(height);
    }
  }
  EXPECT_NEAR(lowest, -0.08, 1e-7);
  EXPECT_NEAR(banks, dug, 0.05 * dug) << "the ends are cut off askew";
  // b^2 = s d (w/2 + d / 2s)
  const double slope = std::tan(25.0 * std::numbers::pi / 180.0);
  EXPECT_NEAR(highest, std::sqrt(slope * 0.08 * (0.1 + 0.04 / slope)), 0.003);
}

TEST(Relief, LiesOnWhatWasThere) {
  HeightField field = HeightField::ramp(2.0, 0.02, 10.0);
  HeightField alone = HeightField::flat(2.0, 0.02);
  const HeightField ramp = field;
  const ReliefOptions options{.seed = 2, .rms_m = 0.01, .mounds = 3, .trench_depth_m = 0.05};
  add_relief(options, field);
  add_relief(options, alone);
  for (int i = 0; i < field.nx(); ++i) {
    EXPECT_NEAR(field.node(i, 20), ramp.node(i, 20) + alone.node(i, 20), 2);
  }
}

TEST(Relief, ABandWithoutAWaveIsSaid) {
  HeightField field = HeightField::flat(1.5, 0.01);
  EXPECT_THROW(add_relief({.rms_m = 0.01, .longest_wave_m = 0.51, .shortest_wave_m = 0.505}, field),
               InputError);
  EXPECT_EQ(field.height_sum(), 0);
}

}  // namespace
}  // namespace screed
