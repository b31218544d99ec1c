// The escape: bounded, ends when the robot is free, gives up when it is not.
#include "firmware/leveling/escape.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "firmware/leveling/leveling.h"
#include "tests/unit/test_robot.h"

namespace screed {
namespace {

Parameters escape_parameters(int16_t attempts) {
  Parameters parameters;
  parameters.escape_attempts() = attempts;
  return parameters;
}

/// Ticks of one attempt that meets no resistance; the first tick is stuck.
int attempt(Escape& escape) {
  int ticks = 0;
  for (bool stuck = true; escape.tick(stuck) && ticks < 10000; stuck = false) ++ticks;
  return ticks;
}

TEST(Escape, AFreeRobotIsLeftAlone) {
  Escape escape(escape_parameters(6));
  for (int i = 0; i < 5000; ++i) {
    ASSERT_FALSE(escape.tick(false));
    ASSERT_FALSE(escape.gave_up());
  }
}

TEST(Escape, DrivesBackFirstAndTurnsAway) {
  Escape escape(escape_parameters(6));
  ASSERT_TRUE(escape.tick(true));
  EXPECT_LT(escape.motion().speed_mm_per_s, 0);
  EXPECT_EQ(escape.motion().yaw_rate, 0);
  YawRate turn = 0;
  int standing = 0;
  while (escape.tick(false)) {
    if (escape.motion().yaw_rate != 0) turn = escape.motion().yaw_rate;
    const bool stands = escape.motion().speed_mm_per_s == 0 && escape.motion().yaw_rate == 0;
    standing = stands ? standing + 1 : 0;
  }
  EXPECT_NE(turn, 0);
  EXPECT_EQ(standing, 40) << "the slip watch forgets while the tracks stand";
  EXPECT_FALSE(escape.gave_up());
  EXPECT_FALSE(escape.tick(false));
}

TEST(Escape, EveryAttemptIsBoundedInTimeSpeedAndDistance) {
  Escape escape(escape_parameters(20));
  for (int i = 0; i < 20; ++i) {
    int ticks = 0;
    double travel_mm = 0.0;
    while (escape.tick(true)) {
      const MotionCommand motion = escape.motion();
      ASSERT_LE(std::abs(motion.speed_mm_per_s), 250);
      ASSERT_LE(std::abs(motion.yaw_rate), yaw_rate_from_degrees(90));
      travel_mm += motion.speed_mm_per_s / 100.0;
      ASSERT_LT(++ticks, 12 * kTickRate_hz) << i;
    }
    EXPECT_GT(ticks, kTickRate_hz) << i;
    EXPECT_LE(std::abs(travel_mm), 700.0) << i;
  }
}

// Otherwise every attempt would lead it farther out, and it would turn back on the spot.
TEST(Escape, OnItsWayHomeItGoesHalfAsFarAndTurnsByLessThan45Degrees) {
  const auto way_of = [](bool homewards) {
    Escape escape(escape_parameters(6));
    std::pair<int, int> way{0, 0};  // 0.01 mm, yaw rates summed
    while (escape.tick(true, false, homewards)) {
      way.first += escape.motion().speed_mm_per_s;
      way.second += escape.motion().yaw_rate;
    }
    return way;
  };
  const auto [far, wide] = way_of(false);
  const auto [near, narrow] = way_of(true);
  EXPECT_NEAR(far, 2 * near, 1000);
  EXPECT_NEAR(wide, 2 * narrow, 5 * yaw_rate_from_degrees(60));
  EXPECT_LT(std::abs(narrow), 45 * kTickRate_hz * yaw_rate_from_degrees(1));
  EXPECT_LT(near, 0);
}

// Stuck once more on its way home it goes on: each attempt that leads back would be farther out.
TEST(Escape, OnItsWayHomeOnlyThePlainAttemptsLeadBack) {
  Escape escape(escape_parameters(6));
  for (int i = 0; i < 6; ++i) {
    int32_t way = 0;  // 0.01 mm
    for (bool stuck = true; escape.tick(stuck, true, true); stuck = false) {
      way += escape.motion().speed_mm_per_s;
    }
    // It drives home backwards.
    if (i == 0 || i == 4) {
      EXPECT_GT(way, 10000) << i;
    } else {
      EXPECT_LT(way, -10000) << i;
    }
  }
}

// What lies behind was passable, and that is ahead for one that drove backwards.
TEST(Escape, OfARobotThatDroveBackwardsIsMirrored) {
  Escape ahead(escape_parameters(6));
  Escape back(escape_parameters(6));
  for (int attempt = 0; attempt < 6; ++attempt) {
    while (ahead.tick(true, false)) {
      ASSERT_TRUE(back.tick(true, true));
      EXPECT_EQ(back.motion().speed_mm_per_s, -ahead.motion().speed_mm_per_s);
      EXPECT_EQ(back.motion().yaw_rate, ahead.motion().yaw_rate);
    }
    EXPECT_FALSE(back.tick(false, true));
  }
}

TEST(Escape, SuccessiveAttemptsDiffer) {
  Escape escape(escape_parameters(6));
  std::vector<std::vector<std::pair<int16_t, YawRate>>> motions;
  for (int i = 0; i < 4; ++i) {
    std::vector<std::pair<int16_t, YawRate>> of_attempt;
    while (escape.tick(true)) {
      of_attempt.emplace_back(escape.motion().speed_mm_per_s, escape.motion().yaw_rate);
    }
    for (const auto& before : motions) EXPECT_NE(of_attempt, before) << i;
    motions.push_back(of_attempt);
  }
}

TEST(Escape, StuckAfterTheLastAttemptItGivesUp) {
  Escape escape(escape_parameters(3));
  for (int i = 0; i < 3; ++i) {
    EXPECT_GT(attempt(escape), 0) << i;
    EXPECT_FALSE(escape.gave_up()) << i;
    for (int tick = 0; tick < 300; ++tick) ASSERT_FALSE(escape.tick(false));
  }
  EXPECT_FALSE(escape.tick(true));
  EXPECT_TRUE(escape.gave_up());
  EXPECT_FALSE(escape.tick(false));
  EXPECT_FALSE(escape.gave_up());
}

TEST(Escape, ARobotThatIsFreeForLongHasAllAttemptsAgain) {
  Escape escape(escape_parameters(1));
  for (int i = 0; i < 5; ++i) {
    EXPECT_GT(attempt(escape), 0) << i;
    for (int tick = 0; tick < 11 * kTickRate_hz; ++tick) escape.tick(false);
  }
  attempt(escape);
  for (int tick = 0; tick < 9 * kTickRate_hz; ++tick) escape.tick(false);
  escape.tick(true);
  EXPECT_TRUE(escape.gave_up());
}

TEST(Escape, WhatTheWatchSaysMeanwhileChangesNothing) {
  Escape free(escape_parameters(6));
  Escape held(escape_parameters(6));
  int ticks = 0;
  while (held.tick(true) && ticks < 10000) ++ticks;
  EXPECT_EQ(ticks, attempt(free));
}

TEST(Escape, ARunBeginsWithAllAttempts) {
  Escape escape(escape_parameters(2));
  attempt(escape);
  attempt(escape);
  escape.tick(true);
  ASSERT_TRUE(escape.gave_up());
  escape.start();
  EXPECT_FALSE(escape.gave_up());
  EXPECT_GT(attempt(escape), 0);
}

TEST(Escape, NoAttemptsIsNoEscapeAndNoFault) {
  Escape escape(escape_parameters(0));
  for (int i = 0; i < 1000; ++i) {
    ASSERT_FALSE(escape.tick(true));
    ASSERT_FALSE(escape.gave_up());
  }
}

/// A motion that lasts: mm/s, degrees/s to the left, ticks.
using Lasting = std::array<int, 3>;

/// What one attempt does, whose first tick is stuck.
std::vector<Lasting> motions_of_attempt(Escape& escape, bool backwards = false,
                                        bool homewards = false) {
  std::vector<Lasting> motions;
  for (bool stuck = true; escape.tick(stuck, backwards, homewards) && motions.size() < 100;
       stuck = false) {
    const MotionCommand motion = escape.motion();
    const auto turn = static_cast<int>(std::lround(motion.yaw_rate * 360.0 / 65536.0));
    if (motions.empty() || motions.back()[0] != motion.speed_mm_per_s || motions.back()[1] != turn)
      motions.push_back({motion.speed_mm_per_s, turn, 0});
    ++motions.back()[2];
  }
  return motions;
}

/// That motion and another one in turn, so many of each, before the others.
void put_first(std::vector<Lasting>& motions, int times, const Lasting& one, const Lasting& other) {
  for (int i = 0; i < times; ++i) motions.insert(motions.begin(), {one, other});
}

/// What docs/algorithms.md says of an attempt, counted from 1.
std::vector<Lasting> documented(int attempt) {
  const int left = attempt % 2 == 1 ? 1 : -1;
  std::vector<Lasting> motions{{-200, 0, 148}, {0, 59 * left, 148}, {0, 0, 40}};
  if (attempt % 4 == 2) put_first(motions, 8, {-250, 0, 48}, {250, 0, 48});
  if (attempt % 4 == 3) put_first(motions, 4, {-100, 59 * left, 48}, {-100, -59 * left, 48});
  if (attempt % 4 == 0) put_first(motions, 5, {-250, 0, 80}, {250, 0, 80});
  return motions;
}

TEST(Escape, BacksOffRocksAndAlternatesTheTracksTurningLeftAndRightInTurn) {
  Escape escape(escape_parameters(20));
  for (int attempt = 1; attempt <= 9; ++attempt)
    EXPECT_EQ(motions_of_attempt(escape), documented(attempt)) << attempt;
}

TEST(Escape, OnItsWayHomeItBacksOffForHalfAsLongAndThenLeadsOn) {
  Escape escape(escape_parameters(20));
  for (int attempt = 1; attempt <= 6; ++attempt) {
    std::vector<Lasting> expected = documented(attempt);
    const size_t last = expected.size() - 1;
    expected[last - 2][2] = 72;
    expected[last - 1][2] = 72;
    if (attempt % 4 != 1)
      for (Lasting& motion : expected) motion[0] = -motion[0];
    EXPECT_EQ(motions_of_attempt(escape, false, true), expected) << attempt;
  }
}

TEST(Escape, FreeForTenSecondsItHasAllAttemptsAgainAndNotBefore) {
  for (const int free : {999, 1000}) {
    Escape escape(escape_parameters(1));
    attempt(escape);
    for (int tick = 0; tick < free; ++tick) ASSERT_FALSE(escape.tick(false));
    EXPECT_EQ(escape.tick(true), free == 1000);
    EXPECT_EQ(escape.gave_up(), free == 999);
  }
}

// Each of the attempts gives it ten seconds to come free.
TEST(Escape, TheAttemptsCountFromTheEndOfTheLast) {
  Escape escape(escape_parameters(2));
  attempt(escape);
  for (int tick = 0; tick < 900; ++tick) ASSERT_FALSE(escape.tick(false));
  attempt(escape);
  for (int tick = 0; tick < 900; ++tick) ASSERT_FALSE(escape.tick(false));
  EXPECT_FALSE(escape.tick(true));
  EXPECT_TRUE(escape.gave_up());
}

// Nobody runs on with the fault stuck; one that did would be free again at its first free tick.
TEST(Escape, HasGivenUpForAsLongAsItIsStuck) {
  Escape escape(escape_parameters(1));
  attempt(escape);
  for (int tick = 0; tick < 2000; ++tick) {
    ASSERT_FALSE(escape.tick(true));
    ASSERT_TRUE(escape.gave_up());
  }
  EXPECT_FALSE(escape.tick(false));
  EXPECT_TRUE(escape.tick(true));
}

TEST(Escape, ARunThatBeginsEndsTheMotion) {
  Escape escape(escape_parameters(6));
  for (const int meanwhile : {1, 100, 200, 310}) {
    for (int tick = 0; tick < meanwhile; ++tick) ASSERT_TRUE(escape.tick(true));
    escape.start();
    EXPECT_FALSE(escape.tick(false)) << meanwhile;
    EXPECT_EQ(motions_of_attempt(escape), documented(1)) << meanwhile;
    escape.start();
  }
}

LevelingInput stuck_input(bool stuck, int16_t x_mm = 0) {
  LevelingInput input{};
  input.stuck = stuck;
  input.place.mm[kX] = x_mm;
  input.drive = {100, 0};
  return input;
}

TEST(LevelingEscape, OnlyOfAlgorithmsThatKeepToTheirSite) {
  for (const LevelingAlgorithm algorithm :
       {LevelingAlgorithm::kDrive, LevelingAlgorithm::kHillSensing, LevelingAlgorithm::kSpinOnPeak,
        LevelingAlgorithm::kTrainingDrive, LevelingAlgorithm::kRandomWalk,
        LevelingAlgorithm::kCoverage}) {
    Parameters parameters;
    parameters.algorithm() = static_cast<int16_t>(algorithm);
    Leveling leveling(parameters);
    leveling.start();
    leveling.tick(stuck_input(true));
    const bool expected =
        algorithm != LevelingAlgorithm::kDrive && algorithm != LevelingAlgorithm::kTrainingDrive;
    EXPECT_EQ(leveling.state() == LevelingState::kEscape, expected) << static_cast<int>(algorithm);
  }
}

TEST(LevelingEscape, TheSiteFenceGoesOnAfterIt) {
  Parameters parameters;
  parameters.site_radius() = 1000;
  Leveling leveling(parameters);
  leveling.start();
  leveling.tick(stuck_input(false, 1100));
  ASSERT_EQ(leveling.state(), LevelingState::kReturn);
  leveling.tick(stuck_input(true, 1100));
  ASSERT_EQ(leveling.state(), LevelingState::kEscape);
  for (int tick = 0; tick < 1000 && leveling.state() == LevelingState::kEscape; ++tick) {
    leveling.tick(stuck_input(false, 1100));
  }
  EXPECT_EQ(leveling.state(), LevelingState::kReturn);
}

TEST(LevelingEscape, BacksOffForHalfAsLongOnTheWayBackToTheSiteOnly) {
  for (const int x_mm : {900, 1100}) {
    Parameters parameters;
    parameters.site_radius() = 1000;
    Leveling leveling(parameters);
    leveling.start();
    leveling.tick(stuck_input(false, static_cast<int16_t>(x_mm)));
    ASSERT_EQ(leveling.state() == LevelingState::kReturn, x_mm > 1000);
    int back = 0;
    int turns = 0;
    for (bool stuck = true; stuck || leveling.state() == LevelingState::kEscape; stuck = false) {
      const MotionCommand motion = leveling.tick(stuck_input(stuck, static_cast<int16_t>(x_mm)));
      ASSERT_LT(back + turns, 1000);
      if (leveling.state() != LevelingState::kEscape) break;
      if (motion.speed_mm_per_s < 0) ++back;
      if (motion.yaw_rate != 0) ++turns;
    }
    EXPECT_EQ(back, x_mm > 1000 ? 72 : 148);
    EXPECT_EQ(turns, x_mm > 1000 ? 72 : 148);
  }
}

// Seeking walls it is stuck at one again and again: each is the first attempt.
TEST(LevelingEscape, AWallIsNoFailedAttempt) {
  Parameters parameters;
  parameters.escape_attempts() = 2;
  Leveling leveling(parameters);
  leveling.start();
  for (int wall = 0; wall < 5; ++wall) {
    leveling.met_wall();
    leveling.tick(stuck_input(true));
    ASSERT_EQ(leveling.state(), LevelingState::kEscape) << wall;
    for (int tick = 0; tick < 400; ++tick) leveling.tick(stuck_input(false));
    ASSERT_NE(leveling.state(), LevelingState::kEscape) << "the first one is short: " << wall;
  }
  EXPECT_FALSE(leveling.gave_up());
}

TEST(LevelingEscape, AClimbThatEndsInItIsNoPeak) {
  Parameters parameters;
  Leveling leveling(parameters);
  leveling.start();
  LevelingInput input = stuck_input(false);
  input.pitch = 3000;
  leveling.tick(input);
  ASSERT_EQ(leveling.state(), LevelingState::kClimb);
  input.stuck = true;
  leveling.tick(input);
  ASSERT_EQ(leveling.state(), LevelingState::kEscape);
  EXPECT_EQ(leveling.peaks(), 0);
}

/// Its tracks turn as they are told and its IMU feels nothing of it.
struct HungUpRobot {
  explicit HungUpRobot(const Parameters& parameters) : robot(parameters) {
    robot.start();
    EXPECT_EQ(robot.state(), RobotState::kRunning);
  }
  /// Ticks until the robot stops running, at most `most`; counts those in the escape.
  int run(int most) {
    int ticks = 0;
    while (robot.state() == RobotState::kRunning && ticks < most) {
      robot.tick();
      ++ticks;
      if (robot.robot.leveling().state() == LevelingState::kEscape) ++escaping;
    }
    return ticks;
  }

  TestRobot robot;
  int escaping = 0;
};

TEST(RobotEscape, ARobotThatHangsHoldsWithTheFaultStuckAfterTheAttempts) {
  Parameters parameters;
  parameters.walk_speed_min() = 150;
  HungUpRobot hung_up(parameters);
  const int ticks = hung_up.run(180 * kTickRate_hz);
  EXPECT_LT(ticks, 120 * kTickRate_hz);
  EXPECT_GT(hung_up.escaping, 6 * kTickRate_hz);
  EXPECT_EQ(hung_up.robot.state(), RobotState::kFault);
  EXPECT_EQ(hung_up.robot.robot.supervisor().faults(), Fault::kStuck);
  EXPECT_EQ(hung_up.robot.output.duty_left, 0);
  EXPECT_EQ(hung_up.robot.output.duty_right, 0);
  // Cleared, it may run again: the cause does not stay.
  hung_up.robot.run(50);
  EXPECT_EQ(hung_up.robot.robot.supervisor().present_faults(), 0);
}

TEST(RobotEscape, TheGroundStationsDriveIsNotInterfered) {
  Parameters parameters;
  parameters.algorithm() = static_cast<int16_t>(LevelingAlgorithm::kDrive);
  HungUpRobot hung_up(parameters);
  hung_up.robot.send(hung_up.robot.command(CommandOp::kDrive, {150, 0}));
  EXPECT_EQ(hung_up.run(60 * kTickRate_hz), 60 * kTickRate_hz);
  EXPECT_EQ(hung_up.escaping, 0);
  EXPECT_TRUE(hung_up.robot.robot.slip_watch().stuck());
}

TEST(RobotEscape, AStopEndsIt) {
  Parameters parameters;
  parameters.walk_speed_min() = 150;
  HungUpRobot hung_up(parameters);
  for (int tick = 0; tick < 60 * kTickRate_hz && hung_up.escaping == 0; ++tick) hung_up.run(1);
  ASSERT_EQ(hung_up.escaping, 1);
  hung_up.robot.send(hung_up.robot.command(CommandOp::kStop));
  hung_up.robot.run(4);
  ASSERT_EQ(hung_up.robot.state(), RobotState::kStopped);
  hung_up.robot.run(100);
  EXPECT_EQ(hung_up.robot.output.duty_left, 0);
  EXPECT_EQ(hung_up.robot.output.duty_right, 0);
}

}  // namespace
}  // namespace screed
