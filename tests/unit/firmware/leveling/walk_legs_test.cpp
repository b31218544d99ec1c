// The robot's random numbers and the walk made of them.
#include "firmware/leveling/walk_legs.h"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <vector>

namespace screed {
namespace {

TEST(RobotRandom, FollowsMarsagliasXorshift) {
  // The triple (13, 17, 5), written down from the paper; eight numbers are skipped after the seed.
  Random random(123);
  uint32_t state = 124U * 2654435769U;
  const auto step = [&state] {
    state ^= state << 13;
    state ^= state >> 17;
    state ^= state << 5;
    return state;
  };
  for (int i = 0; i < 8; ++i) step();
  for (int i = 0; i < 1000; ++i) {
    const auto expected = static_cast<int16_t>(static_cast<int32_t>(step() >> 16) - 32768);
    ASSERT_EQ(random.uniform(INT16_MIN, INT16_MAX), expected);
  }
}

TEST(RobotRandom, BothEndsAreReachedAndEvenlyOften) {
  Random random(7);
  std::map<int16_t, int> seen;
  constexpr int kDraws = 60000;
  for (int i = 0; i < kDraws; ++i) ++seen[random.uniform(-2, 3)];
  ASSERT_EQ(seen.size(), 6U);
  EXPECT_EQ(seen.begin()->first, -2);
  EXPECT_EQ(seen.rbegin()->first, 3);
  // Five standard deviations of a binomial with p = 1/6 are 456.
  for (const auto& [value, count] : seen) EXPECT_NEAR(count, kDraws / 6.0, 456) << value;
}

TEST(RobotRandom, OneValueAndTheWholeRange) {
  Random random(1);
  EXPECT_EQ(random.uniform(5, 5), 5);
  EXPECT_EQ(random.uniform(INT16_MIN, INT16_MIN), INT16_MIN);
  int16_t lowest = 0;
  int16_t highest = 0;
  for (int i = 0; i < 200000; ++i) {
    const int16_t value = random.uniform(INT16_MIN, INT16_MAX);
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
  }
  EXPECT_LT(lowest, -32760);
  EXPECT_GT(highest, 32760);
}

TEST(RobotRandom, NoSeedIsDeadAndNeighboursDiffer) {
  std::set<int32_t> first;
  for (uint32_t seed = 0; seed <= UINT16_MAX; ++seed) {
    Random random(static_cast<uint16_t>(seed));
    const int16_t a = random.uniform(INT16_MIN, INT16_MAX);
    const int16_t b = random.uniform(INT16_MIN, INT16_MAX);
    first.insert(static_cast<int32_t>(a) * 65536 + b);
  }
  EXPECT_GT(first.size(), 65530U);
}

struct Leg {
  MotionCommand motion;
  int ticks;
};

std::vector<Leg> legs(const Parameters& parameters, int ticks) {
  WalkLegs walk(parameters);
  std::vector<Leg> all;
  for (int tick = 0; tick < ticks; ++tick) {
    const MotionCommand motion = walk.tick();
    if (!all.empty() && all.back().motion.speed_mm_per_s == motion.speed_mm_per_s &&
        all.back().motion.yaw_rate == motion.yaw_rate) {
      ++all.back().ticks;
    } else {
      all.push_back({motion, 1});
    }
  }
  all.pop_back();  // cut short
  return all;
}

TEST(WalkLegs, LegsKeepTheirRangesAndFillThem) {
  Parameters parameters;
  parameters.walk_leg_min() = 100;
  parameters.walk_leg_max() = 300;
  const std::vector<Leg> all = legs(parameters, 100000);
  ASSERT_GT(all.size(), 4000U);
  int slowest = 1000;
  int fastest = 0;
  int left_most = -100000;
  int right_most = 100000;
  int shortest = 1000;
  int longest = 0;
  for (const Leg& leg : all) {
    slowest = std::min<int>(slowest, leg.motion.speed_mm_per_s);
    fastest = std::max<int>(fastest, leg.motion.speed_mm_per_s);
    left_most = std::max<int>(left_most, leg.motion.yaw_rate);
    right_most = std::min<int>(right_most, leg.motion.yaw_rate);
    shortest = std::min(shortest, leg.ticks);
    longest = std::max(longest, leg.ticks);
  }
  EXPECT_EQ(slowest, parameters.walk_speed_min());
  EXPECT_EQ(fastest, parameters.walk_speed_max());
  const double limit = parameters.walk_yaw_rate_max() * 65536.0 / 360.0;
  EXPECT_LE(left_most, limit);
  EXPECT_GE(right_most, -limit);
  EXPECT_GT(left_most, 0.99 * limit);
  EXPECT_LT(right_most, -0.99 * limit);
  EXPECT_EQ(shortest, 10);
  EXPECT_GE(longest, 29);
  EXPECT_LE(longest, 30);
}

TEST(WalkLegs, SameSeedSameWalkOtherSeedOtherWalk) {
  Parameters one;
  Parameters two;
  two.random_seed() = 2;
  WalkLegs walk_a(one);
  WalkLegs walk_b(one);
  WalkLegs walk_c(two);
  bool differs = false;
  for (int tick = 0; tick < 5000; ++tick) {
    const MotionCommand a = walk_a.tick();
    const MotionCommand b = walk_b.tick();
    const MotionCommand c = walk_c.tick();
    ASSERT_EQ(a.speed_mm_per_s, b.speed_mm_per_s);
    ASSERT_EQ(a.yaw_rate, b.yaw_rate);
    differs = differs || a.speed_mm_per_s != c.speed_mm_per_s;
  }
  EXPECT_TRUE(differs);
}

TEST(WalkLegs, RestartDrawsANewLeg) {
  Parameters parameters;
  parameters.walk_leg_min() = 20000;
  parameters.walk_leg_max() = 20000;
  WalkLegs walk(parameters);
  const MotionCommand before = walk.tick();
  EXPECT_EQ(walk.tick().yaw_rate, before.yaw_rate);
  walk.restart();
  EXPECT_NE(walk.tick().yaw_rate, before.yaw_rate);
}

}  // namespace
}  // namespace screed
