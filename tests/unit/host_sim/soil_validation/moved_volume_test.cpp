// Volumes told from noisy maps whose true volumes are known.
#include "host_sim/soil_validation/moved_volume.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace screed {
namespace {

constexpr double kArea_m2 = 2.5e-5;
constexpr size_t kNodes = 1000;
constexpr double kTrueRaised_m3 = 100 * 1e-3 * kArea_m2;
constexpr double kTrueSunk_m3 = 200 * 2e-3 * kArea_m2;

/// 100 nodes rise by 1 mm, 200 sink by 2 mm, the others stay; each map has noise of 2 mm.
std::vector<RiseMap> noisy_maps(size_t count, std::mt19937_64& random) {
  std::normal_distribution<double> noise(0.0, 2e-3);
  std::vector<RiseMap> maps(count, RiseMap(kNodes));
  for (RiseMap& map : maps) {
    for (size_t node = 0; node < kNodes; ++node)
      map[node] = (node < 100 ? 1e-3 : node < 300 ? -2e-3 : 0.0) + noise(random);
  }
  return maps;
}

TEST(MovedVolumeTest, TheTrueVolumeLiesBetweenTheTwoEstimates) {
  std::mt19937_64 random(1);
  const std::vector<RiseMap> maps = noisy_maps(64, random);
  MovedVolume last = volume_of_means(maps, kArea_m2, 1);
  for (const size_t beds : {4U, 16U, 64U}) {
    const MovedVolume now = volume_of_means(maps, kArea_m2, beds);
    EXPECT_LT(now.raised_m3, 0.8 * last.raised_m3);
    EXPECT_LT(now.sunk_m3, 0.9 * last.sunk_m3);
    last = now;
  }
  // 700 nodes of noise of 0.25 mm count for 0.1 mm each (s / sqrt(2 pi)), up and down.
  const double noise_m3 = 700 * 0.25e-3 / std::sqrt(2.0 * M_PI) * kArea_m2;
  EXPECT_NEAR(last.raised_m3, kTrueRaised_m3 + noise_m3, 0.1 * noise_m3);
  EXPECT_NEAR(last.sunk_m3, kTrueSunk_m3 + noise_m3, 0.1 * noise_m3);
  const MovedVolume least = volume_without_noise(maps, kArea_m2);
  EXPECT_NEAR(least.raised_m3, kTrueRaised_m3, 0.1 * kTrueRaised_m3);
  EXPECT_NEAR(least.sunk_m3, kTrueSunk_m3, 0.02 * kTrueSunk_m3);
}

// Two others have noise of 1.41 mm: 0.760 of the 1 mm up are taken as up, 0.921 of the 2 mm down as
// down. What is taken wrongly counts against either.
TEST(MovedVolumeTest, FewMapsGiveLessThanTheTruth) {
  std::mt19937_64 random(2);
  MovedVolume mean;
  constexpr int kSets = 200;
  for (int i = 0; i < kSets; ++i) {
    const MovedVolume least = volume_without_noise(noisy_maps(3, random), kArea_m2);
    mean.raised_m3 += least.raised_m3 / kSets;
    mean.sunk_m3 += least.sunk_m3 / kSets;
  }
  EXPECT_NEAR(mean.raised_m3, 0.760 * kTrueRaised_m3 - 0.079 * kTrueSunk_m3, 0.05 * kTrueRaised_m3);
  EXPECT_NEAR(mean.sunk_m3, 0.921 * kTrueSunk_m3 - 0.240 * kTrueRaised_m3, 0.02 * kTrueSunk_m3);
}

TEST(MovedVolumeTest, TheStandardErrorIsTheSpreadOfRepetitions) {
  std::mt19937_64 random(3);
  constexpr int kSets = 200;
  double sum = 0.0;
  double squares = 0.0;
  double error = 0.0;
  for (int i = 0; i < kSets; ++i) {
    const std::vector<RiseMap> maps = noisy_maps(16, random);
    const double raised = volume_of_means(maps, kArea_m2, 16).raised_m3;
    sum += raised;
    squares += raised * raised;
    error += standard_error(maps, kArea_m2).raised_m3 / kSets;
  }
  const double spread = std::sqrt((squares - sum * sum / kSets) / (kSets - 1));
  EXPECT_NEAR(error, spread, 0.2 * spread);
}

TEST(MovedVolumeTest, OneMapTellsNothingOfItsNoise) {
  std::mt19937_64 random(4);
  const std::vector<RiseMap> one = noisy_maps(1, random);
  EXPECT_GT(volume_of_means(one, kArea_m2, 1).raised_m3, 0.0);
  EXPECT_EQ(volume_of_means(one, kArea_m2, 2).raised_m3, 0.0);
  EXPECT_EQ(volume_without_noise(one, kArea_m2).raised_m3, 0.0);
  EXPECT_EQ(standard_error(one, kArea_m2).sunk_m3, 0.0);
}

}  // namespace
}  // namespace screed
