// Position fixes of the simulated camera.
#include "host_sim/ground_station/station/position_fixes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace screed {
namespace {

struct Fixes {
  std::vector<std::uint64_t> ticks;
  std::vector<DriveArgument> places;
};

Fixes fixes(const PositionFixOptions& options, std::uint64_t ticks, std::uint64_t seed = 1,
            double x_m = 1.0, double y_m = -0.5) {
  PositionFixes camera(seed, options);
  Fixes all;
  for (std::uint64_t tick = 0; tick < ticks; ++tick) {
    if (const auto fix = camera.at(tick, x_m, y_m)) {
      all.ticks.push_back(tick);
      all.places.push_back(*fix);
    }
  }
  return all;
}

TEST(PositionFixes, ComeAtTheirPeriodBetweenHeartbeatsAndCommands) {
  EXPECT_TRUE(fixes({0.0, 0.0, 0.0, 0.0}, 100'000).ticks.empty());
  const Fixes all = fixes({1.0, 0.0, 0.0, 0.0}, 10'000);
  ASSERT_EQ(all.ticks.size(), 100U);
  for (std::size_t i = 0; i < all.ticks.size(); ++i) {
    EXPECT_EQ(all.ticks[i], 7 + 100 * i);
    EXPECT_EQ(all.places[i].speed_mm_per_s, 100) << "cm";
    EXPECT_EQ(all.places[i].turn_ddeg_per_s, -50);
  }
  for (const std::uint64_t tick : fixes({0.25, 0.0, 0.0, 0.0}, 10'000).ticks) {
    EXPECT_NE(tick % 20, 0U) << "heartbeat";
    EXPECT_NE(tick % 25, 12U) << "command";
  }
}

TEST(PositionFixes, NoiseIsNormalOnBothAxes) {
  const Fixes all = fixes({0.25, 0.05, 0.0, 0.0}, 2'000'000);
  double sum[2] = {0.0, 0.0};
  double squares[2] = {0.0, 0.0};
  double products = 0.0;
  for (const DriveArgument& it : all.places) {
    const double x = it.speed_mm_per_s - 100.0;
    const double y = it.turn_ddeg_per_s + 50.0;
    sum[0] += x;
    sum[1] += y;
    squares[0] += x * x;
    squares[1] += y * y;
    products += x * y;
  }
  const double n = static_cast<double>(all.places.size());
  ASSERT_EQ(n, 80'000);
  for (int axis = 0; axis < 2; ++axis) {
    EXPECT_NEAR(sum[axis] / n, 0.0, 0.1);
    // 5 cm, and rounding to whole ones: 1 / 12.
    EXPECT_NEAR(std::sqrt(squares[axis] / n), std::sqrt(25.0 + 1.0 / 12.0), 0.1);
  }
  EXPECT_NEAR(products / n / 25.0, 0.0, 0.02);
}

TEST(PositionFixes, OutagesHideWhatWouldHaveBeenSent) {
  const PositionFixOptions with = {1.0, 0.02, 60.0, 10.0};
  const PositionFixOptions without = {1.0, 0.02, 0.0, 10.0};
  const Fixes some = fixes(with, 10'000'000);
  const Fixes all = fixes(without, 10'000'000);
  EXPECT_NEAR(static_cast<double>(some.ticks.size()) / static_cast<double>(all.ticks.size()),
              60.0 / 70.0, 0.02);
  std::size_t i = 0;
  int outages = 0;
  for (std::size_t k = 0; k < some.ticks.size(); ++k) {
    while (all.ticks[i] != some.ticks[k]) ++i;
    EXPECT_EQ(all.places[i].speed_mm_per_s, some.places[k].speed_mm_per_s) << "the same noise";
    if (k > 0 && some.ticks[k] - some.ticks[k - 1] >= 1000) ++outages;
  }
  EXPECT_NEAR(outages, 100'000.0 / 70.0, 150);
}

TEST(PositionFixes, OfASeedAreAlwaysTheSame) {
  const PositionFixOptions options = {1.0, 0.02, 60.0, 10.0};
  EXPECT_EQ(fixes(options, 100'000, 3).ticks, fixes(options, 100'000, 3).ticks);
  EXPECT_NE(fixes(options, 100'000, 3).ticks, fixes(options, 100'000, 4).ticks);
}

TEST(PositionFixes, StopAtTheEndOfTheirRange) {
  const Fixes far = fixes({1.0, 0.0, 0.0, 0.0}, 100, 1, 30.0, -1e9);
  ASSERT_EQ(far.places.size(), 1U);
  EXPECT_EQ(far.places[0].speed_mm_per_s, 2047);
  EXPECT_EQ(far.places[0].turn_ddeg_per_s, -2047);
}

}  // namespace
}  // namespace screed
