// The low-pass, and terrain after it.
#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/physics/terrain/low_pass.h"

namespace screed {

namespace {

// The low-pass against its definition and against what is known in closed form.

using std::numbers::pi;

constexpr FilterEdge kEdges[] = {FilterEdge::kWrapped, FilterEdge::kReflected,
                                 FilterEdge::kRepeated};

/// No two samples alike, no symmetry.
std::vector<double> uneven(int width, int height) {
  std::vector<double> samples;
  samples.reserve(static_cast<size_t>(width) * static_cast<size_t>(height));
  for (int i = 0; i < width * height; ++i) samples.push_back(std::fmod(0.377 * i * i, 1.0));
  return samples;
}

/// The place of a sample within 0..count-1, found by walking.
int walked(int i, int count, FilterEdge edge) {
  if (edge == FilterEdge::kRepeated) return std::clamp(i, 0, count - 1);
  while (i < 0 || i >= count) {
    if (edge == FilterEdge::kWrapped) {
      i += i < 0 ? count : -count;
    } else {
      i = i < 0 ? -1 - i : 2 * count - 1 - i;
    }
  }
  return i;
}

TEST(GaussianFilter, IsTheWeightedSumOfAllNeighbours) {
  constexpr int kWidth = 9;
  constexpr int kHeight = 5;
  for (const double sigma : {0.4, 1.3, 3.1}) {  // the last one reaches beyond the next copies
    const int reach = static_cast<int>(std::ceil(4.0 * sigma));
    double whole = 0.0;
    const auto bell = [sigma](int k) { return std::exp(-0.5 * k * k / (sigma * sigma)); };
    for (int k = -reach; k <= reach; ++k) whole += bell(k);
    for (const FilterEdge edge : kEdges) {
      const std::vector<double> samples = uneven(kWidth, kHeight);
      std::vector<double> filtered = samples;
      gaussian_filter(filtered, kWidth, kHeight, sigma, edge);
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          double sum = 0.0;
          for (int ky = -reach; ky <= reach; ++ky) {
            for (int kx = -reach; kx <= reach; ++kx) {
              const int from =
                  walked(y + ky, kHeight, edge) * kWidth + walked(x + kx, kWidth, edge);
              sum += bell(kx) * bell(ky) * samples[static_cast<size_t>(from)];
            }
          }
          EXPECT_NEAR(filtered[static_cast<size_t>(y * kWidth + x)], sum / (whole * whole), 1e-12)
              << x << ", " << y << ", sigma " << sigma << ", edge " << static_cast<int>(edge);
        }
      }
    }
  }
}

TEST(GaussianFilter, WidensAGaussianBump) {
  // exp(-r^2 / 2 s^2) after sigma is s^2 / (s^2 + sigma^2) exp(-r^2 / 2 (s^2 + sigma^2)).
  constexpr int kMiddle = 60;
  constexpr int kSide = 2 * kMiddle + 1;
  constexpr double kBump = 6.0;
  constexpr double kSigma = 8.0;
  const auto bump = [](int x, int y, double squared) {
    const double dx = x - kMiddle;
    const double dy = y - kMiddle;
    return std::exp(-0.5 * (dx * dx + dy * dy) / squared);
  };
  std::vector<double> samples;
  samples.reserve(size_t{kSide} * kSide);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) samples.push_back(bump(x, y, kBump * kBump));
  }
  gaussian_filter(samples, kSide, kSide, kSigma, FilterEdge::kReflected);
  constexpr double kWide = kBump * kBump + kSigma * kSigma;
  double worst = 0.0;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const double expected = kBump * kBump / kWide * bump(x, y, kWide);
      const double found = samples[static_cast<size_t>(y) * kSide + static_cast<size_t>(x)];
      worst = std::max(worst, std::abs(found - expected));
    }
  }
  EXPECT_LT(worst, 1e-4);  // the weights end at 4 sigma, with 6e-5 of the bell beyond
}

TEST(GaussianFilter, DampsAWaveByItsLength) {
  // A cosine whose period the edge continues stays one, times exp(-(2 pi sigma / L)^2 / 2).
  constexpr int kCount = 80;
  constexpr double kSigma = 7.0;
  const auto expect_damped = [](FilterEdge edge, double period, double phase) {
    std::vector<double> wave;
    wave.reserve(kCount);
    for (int i = 0; i < kCount; ++i) wave.push_back(std::cos(2.0 * pi * (i + phase) / period));
    const std::vector<double> whole = wave;
    gaussian_filter(wave, kCount, 1, kSigma, edge);
    const double kept = std::exp(-0.5 * std::pow(2.0 * pi * kSigma / period, 2.0));
    for (size_t i = 0; i < wave.size(); ++i) EXPECT_NEAR(wave[i], kept * whole[i], 2e-4);
  };
  expect_damped(FilterEdge::kWrapped, 40.0, 0.3);
  expect_damped(FilterEdge::kReflected, 160.0 / 3.0, 0.5);
}

TEST(GaussianFilter, KeepsTheSumUnlessTheEdgeSampleIsRepeated) {
  const auto change_of_sum = [](FilterEdge edge) {
    std::vector<double> samples = uneven(31, 17);
    const double before = std::accumulate(samples.begin(), samples.end(), 0.0);
    gaussian_filter(samples, 31, 17, 5.0, edge);
    return std::accumulate(samples.begin(), samples.end(), 0.0) - before;
  };
  EXPECT_NEAR(change_of_sum(FilterEdge::kWrapped), 0.0, 1e-10);
  EXPECT_NEAR(change_of_sum(FilterEdge::kReflected), 0.0, 1e-10);
  EXPECT_GT(std::abs(change_of_sum(FilterEdge::kRepeated)), 0.1);
}

// Mean planes, and terrain after a low-pass.

using std::numbers::pi;

TEST(MeanPlane, IsThatOfLeastSquares) {
  // A checkerboard of an even number of nodes has no part in any plane.
  const HeightField field = HeightField::from_function(40, 20, 0.01, false, [](double x, double y) {
    const auto place = [](double at) { return std::lround(std::floor(at / 0.01)); };
    const bool black = (place(x) + place(y)) % 2 == 0;
    return 0.25 + 0.3 * x - 0.2 * y + (black ? 0.005 : -0.005);
  });
  const MeanPlane plane = mean_plane(field);
  EXPECT_NEAR(plane.height_m, 0.25, 1e-7);
  EXPECT_NEAR(plane.slope_x, 0.3, 2e-3);  // the checkerboard's corners weigh a little
  EXPECT_NEAR(plane.slope_y, -0.2, 4e-3);
}

TEST(MeanPlane, IsLevelOnTerrainThatRepeats) {
  const HeightField field = HeightField::from_function(
      32, 24, 0.01, true, [](double x, double y) { return 0.1 + 0.5 * x + 0.2 * y * y; });
  EXPECT_EQ(mean_plane(field).slope_x, 0.0);
  EXPECT_EQ(mean_plane(field).slope_y, 0.0);
  EXPECT_NEAR(mean_plane(field).height_m,
              static_cast<double>(field.height_sum()) / (32 * 24) * kHeightUnit_m, 1e-12);
}

TEST(LowPass, LeavesAPlaneAsItIs) {
  const HeightField ramp = HeightField::from_function(
      51, 31, 0.01, false, [](double x, double y) { return 0.4 * x - 0.1 * y; });
  const HeightField filtered = low_passed(ramp, 0.05);
  for (int iy = 0; iy < ramp.ny(); ++iy) {
    for (int ix = 0; ix < ramp.nx(); ++ix)
      ASSERT_NEAR(filtered.node(ix, iy), ramp.node(ix, iy), 1) << ix << ", " << iy;
  }
}

TEST(LowPass, TakesAwayWhatIsShortAndKeepsWhatIsLong) {
  // On the ground: 12.5 mm leaves exp(-2 pi^2 / 4) = 0.7 % of stones 25 mm apart, 99.7 % of 1 m.
  constexpr double kLength_m = 1.0;
  const auto wave = [](double period_m) {
    return HeightField::from_function(200, 200, kLength_m / 200, true, [=](double x, double) {
      return 0.01 * std::cos(2.0 * pi * x / period_m);
    });
  };
  const auto highest_m = [](const HeightField& field) {
    double highest = 0.0;
    for (int ix = 0; ix < field.nx(); ++ix)
      highest = std::max(highest, std::abs(field.node(ix, 7) * kHeightUnit_m));
    return highest;
  };
  EXPECT_NEAR(highest_m(low_passed(wave(0.025), 0.0125)), 0.01 * 0.0072, 2e-6);
  EXPECT_NEAR(highest_m(low_passed(wave(1.0), 0.0125)), 0.01 * 0.99692, 2e-6);
}

TEST(LowPass, KeepsGridAndVolume) {
  HeightField field(60, 40, 0.02, false);
  field.set_node(0, 0, 3000000);
  field.set_node(59, 20, -2000000);
  const HeightField filtered = low_passed(field, 0.06);
  EXPECT_EQ(filtered.nx(), 60);
  EXPECT_EQ(filtered.ny(), 40);
  EXPECT_EQ(filtered.spacing_m(), 0.02);
  EXPECT_FALSE(filtered.wrap());
  EXPECT_NEAR(static_cast<double>(filtered.height_sum()), 1e6, 0.5 * 60 * 40);
  EXPECT_TRUE(low_passed(HeightField(20, 20, 0.01, true), 0.05).wrap());
}

TEST(LowPass, RefusesWidthsOutOfRange) {
  const HeightField flat = HeightField::flat(1.0, 0.1);
  for (const double bad : {0.0, -0.05, 101.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THROW(low_passed(flat, bad), InputError) << bad;
}

}  // namespace

}  // namespace screed
