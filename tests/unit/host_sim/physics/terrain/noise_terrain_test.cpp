// Made-up terrain: it tiles, its seed decides it, and it has the waves that were asked for.
#include "host_sim/physics/terrain/noise_terrain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

#include "host_sim/core/errors.h"

namespace screed {
namespace {

int at(const GreyImage& image, int x, int y) {
  return image
      .samples[static_cast<size_t>(y) * static_cast<size_t>(image.width) + static_cast<size_t>(x)];
}

TEST(NoiseTerrain, TilesWithoutASeam) {
  const GreyImage image = noise_terrain({.seed = 4, .size = 128, .waves = 3, .octaves = 4});
  int within = 0;
  int across = 0;
  for (int i = 0; i < 128; ++i) {
    for (int k = 0; k < 127; ++k) {
      within = std::max({within, std::abs(at(image, k + 1, i) - at(image, k, i)),
                         std::abs(at(image, i, k + 1) - at(image, i, k))});
    }
    across = std::max({across, std::abs(at(image, 0, i) - at(image, 127, i)),
                       std::abs(at(image, i, 0) - at(image, i, 127))});
  }
  EXPECT_LE(across, within);
  EXPECT_LT(within, 12000);  // of 65535: smooth
  EXPECT_GT(across, 0);
}

TEST(NoiseTerrain, ReachesFromBlackToWhite) {
  const GreyImage image = noise_terrain({.seed = 9, .size = 64});
  EXPECT_EQ(*std::min_element(image.samples.begin(), image.samples.end()), 0);
  EXPECT_EQ(*std::max_element(image.samples.begin(), image.samples.end()), 65535);
  EXPECT_EQ(image.max_value, 65535);
}

TEST(NoiseTerrain, TheSeedDecides) {
  EXPECT_EQ(noise_terrain({.seed = 2, .size = 32}).samples,
            noise_terrain({.seed = 2, .size = 32}).samples);
  EXPECT_NE(noise_terrain({.seed = 2, .size = 32}).samples,
            noise_terrain({.seed = 3, .size = 32}).samples);
}

TEST(NoiseTerrain, MoreWavesAreSteeper) {
  const auto roughness = [](int waves) {
    const GreyImage image = noise_terrain({.seed = 5, .size = 256, .waves = waves, .octaves = 1});
    double sum = 0.0;
    for (int y = 0; y < 256; ++y) {
      for (int x = 0; x < 255; ++x) sum += std::abs(at(image, x + 1, y) - at(image, x, y));
    }
    return sum;
  };
  EXPECT_GT(roughness(8), 1.7 * roughness(4));
}

// The commands of host_sim/data/terrain/README.md.
TEST(NoiseTerrain, TheCommittedMapsAreMadeByTheirCommands) {
  const auto committed = [](const char* name) {
    return read_grey_image(std::string("host_sim/data/terrain/") + name);
  };
  EXPECT_EQ(committed("terrain_a.png").samples,
            noise_terrain({.seed = 1, .waves = 2, .octaves = 4, .persistence = 0.4}).samples);
  EXPECT_EQ(committed("terrain_b.png").samples,
            noise_terrain({.seed = 2, .waves = 4, .octaves = 3, .persistence = 0.5}).samples);
  const GreyImage large =
      noise_terrain({.seed = 3, .size = 600, .waves = 6, .octaves = 4, .persistence = 0.45});
  const GreyImage bmp = committed("terrain_large.bmp");
  ASSERT_EQ(bmp.samples.size(), large.samples.size());
  for (size_t i = 0; i < bmp.samples.size(); ++i) {
    ASSERT_NEAR(bmp.samples[i] * 257.0, large.samples[i], 129.0) << i;
  }
}

TEST(NoiseTerrain, OptionsOutOfRangeAreRefused) {
  EXPECT_THROW(noise_terrain({.size = 8}), InputError);
  EXPECT_THROW(noise_terrain({.waves = 0}), InputError);
  EXPECT_THROW(noise_terrain({.octaves = 11}), InputError);
  EXPECT_THROW(noise_terrain({.persistence = -0.1}), InputError);
}

}  // namespace
}  // namespace screed
