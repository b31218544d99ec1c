// What counts as dug in, detected and false, on drives made up by hand.
#include "nn/slip/slip_campaign.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

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

// ---- What the slip watch's network is to say of the steps of a drive

/// Stands for a second, then its tracks turn; the chassis follows with this share until tick
/// `stops`, and not at all from then on.
SlipDrive drive_with(double share, std::size_t stops, std::size_t ticks) {
  SlipDrive drive;
  for (std::size_t i = 0; i < ticks; ++i) {
    SlipTick tick{};
    tick.running = true;
    tick.accel = {0, 0, 4098};
    if (i >= 100) {
      tick.speed_left = 1500;
      tick.speed_right = 1500;
      tick.track_left = 0.15F;
      tick.track_right = 0.15F;
      tick.speed = i < stops ? static_cast<float>(0.15 * share) : 0.0F;
    }
    drive.ticks.push_back(tick);
  }
  return drive;
}

std::vector<SlipStep> steps_of(const SlipDrive& drive) {
  return slip_steps(drive, TrueMotion(drive));
}

TEST(SlipSequence, AStepIsEveryFourthTickOfTurningTracks) {
  const auto steps = steps_of(drive_with(1.0, 1000, 500));
  ASSERT_GT(steps.size(), 90U);
  EXPECT_TRUE(steps[0].forgets);
  EXPECT_GE(steps[0].tick, 100U);
  for (std::size_t i = 1; i < steps.size(); ++i) {
    EXPECT_EQ(steps[i].tick, steps[i - 1].tick + 4);
    EXPECT_FALSE(steps[i].forgets);
  }
}

TEST(SlipSequence, TracksThatStoodBeginAnew) {
  SlipDrive drive = drive_with(1.0, 1000, 600);
  for (std::size_t i = 300; i < 310; ++i)
    drive.ticks[i].speed_left = drive.ticks[i].speed_right = 0;
  const auto steps = steps_of(drive);
  EXPECT_EQ(std::count_if(steps.begin(), steps.end(), [](auto& step) { return step.forgets; }), 2);
  const auto second = std::find_if(steps.begin() + 1, steps.end(),
                                   [](const SlipStep& step) { return step.forgets; });
  EXPECT_GT(second->tick, 309U);
}

TEST(SlipSequence, HeldIsWhatHardlyMovesAndHasNotMovedForAWhile) {
  const std::size_t stops = 400;
  for (const SlipStep& step : steps_of(drive_with(1.0, stops, 800))) {
    if (step.tick < stops + 29) {
      EXPECT_TRUE(step.held == 0.0F && step.held_weight == 1.0F) << step.tick;
    }
    if (step.tick > stops + 31 && step.tick < 780) {
      EXPECT_TRUE(step.held == 1.0F && step.held_weight == 1.0F) << step.tick;
    }
  }
}

TEST(SlipSequence, WhatLiesBetweenTeachesNothing) {
  for (const auto& [share, held, weight] :
       {std::tuple(0.2, 1.0F, 1.0F), std::tuple(0.3, 0.0F, 0.0F), std::tuple(0.45, 0.0F, 1.0F)}) {
    const auto steps = steps_of(drive_with(share, 1000, 800));
    EXPECT_EQ(steps[100].held, held) << share;
    EXPECT_EQ(steps[100].held_weight, weight) << share;
  }
}

TEST(SlipSequence, TheShareIsThatOfTheLastHalfSecond) {
  const auto steps = steps_of(drive_with(0.8, 400, 800));
  for (const SlipStep& step : steps) {
    if (step.tick < 150) continue;
    const double moving = std::clamp((450.0 - step.tick) / 50.0, 0.0, 1.0);
    EXPECT_NEAR(step.share, 0.8 * moving, 1e-4) << step.tick;
    EXPECT_NEAR(step.share_weight, 0.15, 1e-4);
  }
}

TEST(SlipSequence, ARobotThatDoesNotRunTeachesNothing) {
  SlipDrive drive = drive_with(1.0, 1000, 500);
  for (SlipTick& tick : drive.ticks) tick.running = false;
  for (const SlipStep& step : steps_of(drive)) {
    EXPECT_EQ(step.held_weight, 0.0F);
    EXPECT_EQ(step.share_weight, 0.0F);
  }
  for (const WatchTick& tick : watch_of(drive)) EXPECT_FALSE(tick.evaluated);
}

// ---- Drives and errors of the slip watch's figures

TEST(SlipCampaign, ErrorsOfTheShareAreWeighted) {
  ShareError error;
  error.add(0.9, 1.0, 3.0);
  error.add(0.4, 0.2, 1.0);
  EXPECT_NEAR(error.true_mean(), 0.8, 1e-12);
  EXPECT_NEAR(error.mean(), (3.0 * -0.1 + 0.2) / 4.0, 1e-12);
  EXPECT_NEAR(error.rms(), std::sqrt((3.0 * 0.01 + 0.04) / 4.0), 1e-12);
  EXPECT_NEAR(error.rms_of_one(), std::sqrt(0.64 / 4.0), 1e-12);
  EXPECT_NEAR(error.rms_of_mean(), std::sqrt((3.0 * 0.04 + 0.36) / 4.0), 1e-12);
}

TEST(SlipCampaign, ScenariosFollowTheNumbersAndTheSeed) {
  SlipCampaign campaign;
  campaign.seed = 40;
  campaign.trapped = 2;
  campaign.ordinary = 1;
  campaign.duration_s = 30.0;
  const auto all = scenarios(campaign);
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[1].kind, ScenarioKind::kTrapped);
  EXPECT_EQ(all[1].experiment.experiment.seed, 41U);
  EXPECT_EQ(all[2].kind, ScenarioKind::kOrdinary);
  EXPECT_EQ(all[2].experiment.experiment.seed, 40U);
  EXPECT_EQ(all[2].experiment.experiment.duration_s, 30.0);
}

}  // namespace
}  // namespace screed::nn
