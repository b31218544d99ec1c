// The world's generator against the published PCG32, and the distributions made of it.
#include "host_sim/core/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string_view>

namespace screed {
namespace {

/// PCG32 as published (O'Neill, pcg32_random_r and pcg32_srandom_r).
struct ReferencePcg32 {
  uint64_t state = 0;
  uint64_t increment = 0;

  ReferencePcg32(uint64_t seed, uint64_t stream) : increment((stream << 1U) | 1U) {
    next();
    state += seed;
    next();
  }
  uint32_t next() {
    const uint64_t old = state;
    state = old * 6364136223846793005ULL + increment;
    const auto shifted = static_cast<uint32_t>(((old >> 18U) ^ old) >> 27U);
    const auto rotation = static_cast<uint32_t>(old >> 59U);
    return (shifted >> rotation) | (shifted << ((0U - rotation) & 31U));
  }
};

uint64_t fnv1a(std::string_view text) {
  uint64_t hash = 14695981039346656037ULL;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  return hash;
}

TEST(WorldRandom, IsPcg32) {
  // The reference is right: output of the demo program, seed 42, stream 54.
  ReferencePcg32 demo(42, 54);
  for (const uint32_t expected :
       {0xa15c02b7U, 0x7b47f409U, 0xba1d3330U, 0x83d2f293U, 0xbfa4784bU, 0xcbed606eU}) {
    ASSERT_EQ(demo.next(), expected);
  }
  for (const char* name : {"gyro", "uplink", ""}) {
    for (const uint64_t seed : {0ULL, 1ULL, ~0ULL}) {
      WorldRandom random(seed, name);
      ReferencePcg32 reference(seed, fnv1a(name));
      for (int i = 0; i < 100; ++i) ASSERT_EQ(random.next(), reference.next());
    }
  }
}

TEST(WorldRandom, ComponentsAndSeedsAreIndependent) {
  WorldRandom a(1, "gyro");
  WorldRandom b(1, "barometer");
  WorldRandom c(2, "gyro");
  int same = 0;
  for (int i = 0; i < 1000; ++i) {
    const uint32_t value = a.next();
    if (value == b.next()) ++same;
    if (value == c.next()) ++same;
  }
  EXPECT_EQ(same, 0);
}

TEST(WorldRandom, UniformIsWithinItsRangeAndEven) {
  WorldRandom random(1, "test");
  constexpr int kDraws = 100000;
  int bins[10] = {};
  double sum = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double value = random.uniform(-2.0, 3.0);
    ASSERT_GE(value, -2.0);
    ASSERT_LT(value, 3.0);
    ++bins[static_cast<int>((value + 2.0) * 2.0)];
    sum += value;
  }
  EXPECT_NEAR(sum / kDraws, 0.5, 5.0 * 5.0 / std::sqrt(12.0 * kDraws));
  for (const int bin : bins) EXPECT_NEAR(bin, kDraws / 10.0, 5.0 * std::sqrt(0.09 * kDraws));
}

TEST(WorldRandom, NormalHasItsMoments) {
  WorldRandom random(1, "test");
  constexpr int kDraws = 200000;
  double sum = 0.0;
  double square = 0.0;
  double fourth = 0.0;
  double product = 0.0;
  double last = 0.0;
  int beyond_two = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double value = random.normal();
    sum += value;
    square += value * value;
    fourth += value * value * value * value;
    product += value * last;
    last = value;
    if (std::abs(value) > 1.959964) ++beyond_two;
  }
  const double n = kDraws;
  EXPECT_NEAR(sum / n, 0.0, 5.0 / std::sqrt(n));
  EXPECT_NEAR(square / n, 1.0, 5.0 * std::sqrt(2.0 / n));
  EXPECT_NEAR(fourth / n, 3.0, 5.0 * std::sqrt(96.0 / n));
  EXPECT_NEAR(product / n, 0.0, 5.0 / std::sqrt(n));  // the two of a pair are independent
  EXPECT_NEAR(beyond_two / n, 0.05, 5.0 * std::sqrt(0.05 * 0.95 / n));
}

}  // namespace
}  // namespace screed
