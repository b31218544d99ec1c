// The low-pass against its definition and against what is known in closed form.
#include "host_sim/physics/terrain/gaussian_filter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

namespace screed {
namespace {

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

}  // namespace
}  // namespace screed
