// What the slip watch's network is to say of the steps of a drive.
#include "nn/slip/slip_sequence.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "nn/slip/slip_replay.h"

namespace screed::nn {
namespace {

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

}  // namespace
}  // namespace screed::nn
