// What counts as dug in, detected and false, on drives made up by hand.
#include "nn/slip/stuck_rules.h"

#include <gtest/gtest.h>

namespace screed::nn {
namespace {

constexpr float kTracks = 0.2F;

/// Moves as its tracks do until tick `stops` and not at all from then on.
SlipDrive drive_that_stops(std::size_t stops, std::size_t ticks, ScenarioKind kind) {
  SlipDrive drive;
  drive.kind = kind;
  drive.trap = kind == ScenarioKind::kTrapped ? "wall" : "none";
  for (std::size_t i = 0; i < ticks; ++i) {
    SlipTick tick{};
    tick.running = true;
    tick.track_left = kTracks;
    tick.track_right = kTracks;
    tick.speed = i < stops ? kTracks : 0.0F;
    drive.ticks.push_back(tick);
  }
  return drive;
}

/// Stuck from tick `begin` to before `end`.
std::vector<WatchTick> alarm(std::size_t ticks, std::size_t begin, std::size_t end) {
  std::vector<WatchTick> watch;
  for (std::size_t i = 0; i < ticks; ++i) watch.push_back({true, i >= begin && i < end});
  return watch;
}

StuckCounts counts_of(const SlipDrive& drive, const std::vector<WatchTick>& watch) {
  return count_alarms(drive, TrueMotion(drive), watch);
}

TEST(StuckRules, DugInIsWhereTheChassisNoLongerFollows) {
  const auto dug_in = TrueMotion(drive_that_stops(500, 1000, ScenarioKind::kTrapped)).dug_in_at();
  ASSERT_TRUE(dug_in);
  EXPECT_GE(*dug_in, 500U);
  EXPECT_LE(*dug_in, 515U);
  EXPECT_FALSE(TrueMotion(drive_that_stops(1000, 1000, ScenarioKind::kTrapped)).dug_in_at());
  EXPECT_FALSE(TrueMotion(drive_that_stops(950, 1000, ScenarioKind::kTrapped)).dug_in_at())
      << "half a second, as a stall fault leaves it";
}

TEST(StuckRules, SharesAreOfTravelAndOfForwardTravel) {
  SlipDrive drive = drive_that_stops(100, 200, ScenarioKind::kFree);
  for (SlipTick& tick : drive.ticks) tick.turn = 0.02F;
  const TrueMotion motion(drive);
  EXPECT_NEAR(motion.travel_share(0, 100), 1.1, 1e-6);
  EXPECT_NEAR(motion.travel_share(100, 200), 0.1, 1e-6);
  EXPECT_NEAR(motion.forward_share(0, 200).share, 0.5, 1e-6);
  EXPECT_NEAR(motion.forward_share(0, 200).belts_m, 0.4, 1e-6);
  for (SlipTick& tick : drive.ticks) tick.track_left = -kTracks;
  EXPECT_EQ(TrueMotion(drive).forward_share(0, 200).belts_m, 0.0) << "a turn in place";
}

TEST(StuckRules, AnAlarmWithinTheSecondIsADetection) {
  const SlipDrive drive = drive_that_stops(500, 1000, ScenarioKind::kTrapped);
  const std::size_t dug_in = *TrueMotion(drive).dug_in_at();
  const StuckCounts counts = counts_of(drive, alarm(1000, dug_in + 40, 900));
  EXPECT_EQ(counts.dug_in, 1);
  EXPECT_EQ(counts.detected, 1);
  EXPECT_NEAR(counts.delay_s, 0.4, 1e-9);
  EXPECT_EQ(counts.early_alarms, 0);
  EXPECT_EQ(counts.driven_s, 0.0) << "hours are those without a trap";
  EXPECT_EQ(counts_of(drive, alarm(1000, dug_in + 101, 1000)).detected, 0);
}

TEST(StuckRules, AnAlarmBeforeDiggingInIsEarly) {
  const SlipDrive drive = drive_that_stops(500, 1000, ScenarioKind::kTrapped);
  const StuckCounts early = counts_of(drive, alarm(1000, 300, 1000));
  EXPECT_EQ(early.early_alarms, 1);
  EXPECT_EQ(early.detected, 0) << "it was on all the time";
  const StuckCounts twice = counts_of(drive, [] {
    auto watch = alarm(1000, 300, 320);
    for (std::size_t i = 540; i < 600; ++i) watch[i].stuck = true;
    return watch;
  }());
  EXPECT_EQ(twice.early_alarms, 1);
  EXPECT_EQ(twice.detected, 1);
  const std::size_t dug_in = *TrueMotion(drive).dug_in_at();
  const StuckCounts both = counts_of(drive, alarm(1000, dug_in - 20, 1000));
  EXPECT_EQ(both.early_alarms, 1);
  EXPECT_EQ(both.detected, 1);
  EXPECT_EQ(both.delay_s, 0.0);
  EXPECT_EQ(both.trapped, 1);
}

TEST(StuckRules, WithoutATrapEveryAlarmOfARobotThatMovedIsFalse) {
  const SlipDrive drive = drive_that_stops(500, 1000, ScenarioKind::kFree);
  EXPECT_EQ(counts_of(drive, alarm(1000, 100, 200)).false_alarms, 1);
  EXPECT_EQ(counts_of(drive, alarm(1000, 520, 600)).false_alarms, 1)
      << "0.3 s of the half second before it moved";
  const StuckCounts right = counts_of(drive, alarm(1000, 560, 600));
  EXPECT_EQ(right.false_alarms, 0);
  EXPECT_EQ(right.other_alarms, 1);
  EXPECT_EQ(right.dug_in, 0);
}

TEST(StuckRules, ARobotThatComesFreeAtOnceCountsByItself) {
  SlipDrive drive = drive_that_stops(500, 1000, ScenarioKind::kFree);
  for (std::size_t i = 560; i < 1000; ++i) drive.ticks[i].speed = kTracks;
  const StuckCounts counts = counts_of(drive, alarm(1000, 555, 600));
  EXPECT_EQ(counts.false_alarms, 0);
  EXPECT_EQ(counts.recovered_alarms, 1);
}

}  // namespace
}  // namespace screed::nn
