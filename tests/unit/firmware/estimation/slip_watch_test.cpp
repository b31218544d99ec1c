// The slip watch on tracks, inertia and turns made up by hand.
#include "firmware/estimation/slip_watch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <climits>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <random>
#include <sstream>
#include <utility>
#include <vector>

#include "firmware/estimation/slip_model.h"
#include "nn/slip/slip_model.h"
#include "paths.h"

namespace screed {
namespace {

constexpr uint16_t kTread_mm = 195;
constexpr double kCountsPerG = 4098.0;

/// A robot that drives straight on or turns; what it feels of that is up to the test. Ground that
/// it moves over shakes it.
struct Drive {
  SlipWatch watch{kTread_mm};
  double speed_mm_per_s = 0.0;
  std::mt19937 random{1};

  struct Feeling {
    double share = 1.0;     ///< of the belts' motion that is the robot's
    int16_t effort = 12;    ///< duty a track beyond what drives it unloaded
    double braking = 0.0;   ///< m/s^2 that the belts do not show
    std::int32_t turn = 0;  ///< angle units/s
  };

  /// Both tracks go to `target`, by 600 mm/s^2 at most, the right one `turn` faster, the left one
  /// as much slower.
  void go(double target_mm_per_s, double seconds, const Feeling& feeling, double turn = 0.0) {
    std::normal_distribution<double> noise;
    for (int i = 0; i < std::lround(seconds * 100.0); ++i) {
      const double change = std::clamp(target_mm_per_s - speed_mm_per_s, -6.0, 6.0);
      speed_mm_per_s += change;
      const double accel_g = (feeling.share * change * 0.1 - feeling.braking) / 9.80665;
      const bool moves = (speed_mm_per_s != 0.0 || turn != 0.0) && feeling.share > 0.5;
      const double shaking = 2.0 + (moves ? 25.0 : 0.0);
      const auto shaken = [&](double counts) {
        return static_cast<int16_t>(std::lround(counts + shaking * noise(random)));
      };
      const TrackMotion left = {static_cast<int16_t>((speed_mm_per_s - turn) * 10.0),
                                feeling.effort};
      const TrackMotion right = {static_cast<int16_t>((speed_mm_per_s + turn) * 10.0),
                                 feeling.effort};
      const int16_t gyro[] = {shaken(0.0), shaken(0.0), 0};
      const int16_t accel[] = {shaken(accel_g * kCountsPerG), 0, shaken(kCountsPerG)};
      watch.tick(left, right, gyro, accel, 0, feeling.turn, i % 2 == 0);
    }
  }
};
constexpr Drive::Feeling kStands = {0.0, 0, 0.0, 0};

/// A tick by the units of the sensors, for what a single unit decides.
struct Measured {
  int16_t left = 1000;  ///< 0.1 mm/s
  int16_t right = 1000;
  int16_t left_effort = 0;  ///< duty
  int16_t right_effort = 0;
  int16_t pitch_rate = 0;  ///< counts
  int16_t ahead = 0;       ///< counts of the accelerometer
  int16_t up = 0;
  int16_t sin_pitch_q14 = 0;

  static Measured straight_on(int speed_dmm_per_s) {
    Measured it;
    it.left = static_cast<int16_t>(speed_dmm_per_s);
    it.right = it.left;
    return it;
  }
  /// The speed that the robot loses in this tick while its tracks go on, in two counts over a tick,
  /// 0.048 mm/s.
  Measured losing(int units) const {
    Measured it = *this;
    it.ahead = static_cast<int16_t>(-2 * units);
    return it;
  }
  TrackMotion left_track() const { return {left, left_effort}; }
  TrackMotion right_track() const { return {right, right_effort}; }
};

void tick(SlipWatch& watch, const Measured& it, bool classify_now = true) {
  const int16_t gyro[] = {0, it.pitch_rate, 0};
  const int16_t accel[] = {it.ahead, 0, it.up};
  watch.tick(it.left_track(), it.right_track(), gyro, accel, it.sin_pitch_q14, 0, classify_now);
}
void pass_over(SlipWatch& watch, const Measured& it) {
  watch.pass_over(it.left_track(), it.right_track());
}
/// A watch that knows the belts' speed and has felt nothing yet.
SlipWatch watch_at(const Measured& it) {
  SlipWatch watch(kTread_mm);
  pass_over(watch, it);
  return watch;
}

TEST(SlipWatch, TracksThatStandTellNothing) {
  Drive drive;
  drive.go(0.0, 20.0, kStands);
  EXPECT_FALSE(drive.watch.slips());
  EXPECT_FALSE(drive.watch.stuck());
}

// A battery at half the motors' voltage doubles the feed-forward: the effort is what is missing.
TEST(SlipWatch, GreatEffortsDoNotOverflow) {
  for (const int16_t effort : std::initializer_list<int16_t>{1200, -1200, 16000, -16000}) {
    SlipWatch watch(kTread_mm);
    const TrackMotion track = {1000, effort};
    const int16_t gyro[] = {0, 0, 0};
    const int16_t accel[] = {0, 0, 4098};
    for (int tick = 0; tick < 400; ++tick) {
      watch.tick(track, track, gyro, accel, 0, 0, true);
      if (tick < 8) continue;
      ASSERT_EQ(watch.network_inputs()[7] > 0, effort > 0) << effort << " tick " << tick;
    }
  }
}

TEST(SlipWatch, ARobotThatMeasuresItsStartIsFree) {
  for (const double speed : {80.0, 150.0, 200.0}) {
    Drive drive;
    drive.go(0.0, 5.0, kStands);
    for (int i = 0; i < 40; ++i) {
      drive.go(speed, 0.5, {});
      ASSERT_FALSE(drive.watch.stuck()) << speed << " mm/s, " << i << " / 2 s";
    }
    EXPECT_FALSE(drive.watch.slips()) << speed;
  }
}

TEST(SlipWatch, OneThatStopsWhileItsTracksGoOnIsStuckWithinASecond) {
  for (const double speed : {100.0, 150.0, 200.0}) {
    Drive drive;
    drive.go(0.0, 5.0, kStands);
    drive.go(speed, 5.0, {});
    ASSERT_FALSE(drive.watch.stuck()) << speed;
    // It runs into something: 0.2 s of braking that the tracks do not show.
    drive.go(speed, 0.2, {0.0, 60, speed / 200.0, 0});
    drive.go(speed, 0.8, {0.0, 60, 0.0, 0});
    EXPECT_TRUE(drive.watch.stuck()) << speed;
    // Tracks that stop are not stuck.
    drive.go(0.0, 1.0, kStands);
    EXPECT_FALSE(drive.watch.stuck()) << speed;
  }
}

TEST(SlipWatch, OneThatStartsAnewIsNoLongerStuck) {
  Drive drive;
  drive.go(0.0, 5.0, kStands);
  drive.go(150.0, 3.0, {});
  drive.go(150.0, 0.2, {0.0, 60, 0.75, 0});
  drive.go(150.0, 2.0, {0.0, 60, 0.0, 0});
  ASSERT_TRUE(drive.watch.stuck());
  EXPECT_LT(drive.watch.travel_share(), 64);
  drive.go(0.0, 0.5, kStands);
  EXPECT_FALSE(drive.watch.stuck());
  EXPECT_EQ(drive.watch.travel_share(), 255);
  drive.go(150.0, 3.0, {});
  EXPECT_FALSE(drive.watch.stuck()) << "it has forgotten";
  EXPECT_GT(drive.watch.travel_share(), 192);
}

// Whatever it feels, the evidence decides: stuck from one threshold, free below another, and
// between them what it was.
TEST(SlipWatch, SlipsIsStuckAndIsFreeFromTheModelsThresholds) {
  using nn::model_slip::kFreeEvidence;
  using nn::model_slip::kSlipEvidence;
  using nn::model_slip::kStuckEvidence;
  static_assert(kFreeEvidence < kSlipEvidence && kSlipEvidence <= kStuckEvidence);
  Drive drive;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform;
  drive.go(0.0, 5.0, kStands);
  int rising = 0;
  int falling = 0;
  int held = 0;
  for (int piece = 0; piece < 400; ++piece) {
    const Drive::Feeling feeling = {uniform(random) < 0.5 ? 1.0 : 0.0,
                                    static_cast<std::int16_t>(uniform(random) * 80.0),
                                    (uniform(random) - 0.5) * 1.5, 0};
    const double speed = 80.0 + 120.0 * uniform(random);
    for (int i = 0; i < 25; ++i) {
      const bool was_stuck = drive.watch.stuck();
      drive.go(speed, 0.04, feeling);
      const std::uint16_t evidence = drive.watch.evidence();
      ASSERT_EQ(drive.watch.slips(), evidence >= kSlipEvidence) << evidence;
      if (evidence >= kStuckEvidence) {
        ASSERT_TRUE(drive.watch.stuck()) << evidence;
        rising += was_stuck ? 0 : 1;
      } else if (evidence < kFreeEvidence) {
        ASSERT_FALSE(drive.watch.stuck()) << evidence;
        falling += was_stuck ? 1 : 0;
      } else {
        ASSERT_EQ(drive.watch.stuck(), was_stuck) << evidence;
        held += was_stuck ? 1 : 0;
      }
    }
  }
  EXPECT_GE(rising, 3);
  EXPECT_GE(falling, 3);
  EXPECT_GE(held, 3);
}

// Half of the speed lost within a few ticks while the tracks go on. What is lost slowly, with the
// tracks, or by hand from outside at rest is no collision.
TEST(SlipWatch, ACollisionIsSpeedLostAtOnce) {
  const auto collides = [](double speed, double seconds, double braking, double target) {
    Drive drive;
    drive.go(0.0, 5.0, kStands);
    drive.go(speed, 3.0, {});
    EXPECT_FALSE(drive.watch.collided()) << speed;
    drive.go(target, seconds, {target == speed ? 0.0 : 1.0, 60, braking, 0});
    return drive.watch.collided();
  };
  EXPECT_TRUE(collides(150.0, 0.05, 3.0, 150.0)) << "all of it in 50 ms";
  EXPECT_TRUE(collides(100.0, 0.05, 2.0, 100.0));
  EXPECT_FALSE(collides(150.0, 1.0, 0.15, 150.0)) << "dug in within a second";
  EXPECT_FALSE(collides(150.0, 0.05, 0.6, 150.0)) << "a fifth of it";
  EXPECT_FALSE(collides(150.0, 0.3, 0.0, 0.0)) << "brakes by its tracks";

  Drive drive;
  drive.go(0.0, 5.0, kStands);
  drive.go(0.0, 0.05, {0.0, 0, 3.0, 0});
  EXPECT_FALSE(drive.watch.collided()) << "kicked at rest";
  drive.go(150.0, 3.0, {});
  drive.go(150.0, 0.05, {0.0, 60, 3.0, 0});
  ASSERT_TRUE(drive.watch.collided());
  drive.go(150.0, 2.4, {0.0, 60, 0.0, 0});
  EXPECT_TRUE(drive.watch.collided()) << "remembered for 2.5 s";
  drive.go(150.0, 0.2, {0.0, 60, 0.0, 0});
  EXPECT_FALSE(drive.watch.collided());
}

// A unit of 0.048 mm/s for each 0.1 mm/s of the belts: nearly half of their speed.
TEST(SlipWatch, ACollisionTakesHalfOfTheSpeedToTheUnit) {
  const auto collides = [](int speed_dmm_per_s, int units) {
    const Measured driving = Measured::straight_on(speed_dmm_per_s);
    SlipWatch watch = watch_at(driving);
    tick(watch, driving.losing(units));
    return watch.collided();
  };
  for (const int speed : {500, 1000, 2000, -1000}) {
    const int sign = speed < 0 ? -1 : 1;
    EXPECT_TRUE(collides(speed, sign * std::abs(speed))) << speed;
    EXPECT_FALSE(collides(speed, sign * (std::abs(speed) - 1))) << speed;
  }
  EXPECT_TRUE(collides(500, 7000)) << "50 mm/s";
  EXPECT_FALSE(collides(498, 7000)) << "slower, it tells nothing";
}

TEST(SlipWatch, OfWhatATickLosesNoMoreThan8000UnitsCount) {
  for (const int units : {8000, 9000, 16000}) {
    SlipWatch slower = watch_at(Measured::straight_on(8000));
    tick(slower, Measured::straight_on(8000).losing(units));
    EXPECT_TRUE(slower.collided()) << units;
    SlipWatch faster = watch_at(Measured::straight_on(8004));
    tick(faster, Measured::straight_on(8004).losing(units));
    EXPECT_FALSE(faster.collided()) << units;
  }
}

// A quarter of what was lost is forgotten in each tick, rounded down.
TEST(SlipWatch, WhatWasLostInTheTicksBeforeBelongsToACollision) {
  const Measured driving = Measured::straight_on(500);
  const auto collides = [&](std::initializer_list<int> losses) {
    SlipWatch watch = watch_at(driving);
    for (const int units : losses) tick(watch, driving.losing(units));
    return watch.collided();
  };
  EXPECT_TRUE(collides({3, 497})) << "less than four are not forgotten yet";
  EXPECT_FALSE(collides({3, 496}));
  EXPECT_TRUE(collides({400, 200}));
  EXPECT_FALSE(collides({400, 199}));
  EXPECT_TRUE(collides({-400, 820})) << "gained, then lost";
  EXPECT_FALSE(collides({-400, 780}));

  SlipWatch slowly = watch_at(driving);
  SlipWatch quickly = watch_at(driving);
  for (int i = 0; i < 30; ++i) {
    tick(slowly, driving.losing(120));
    ASSERT_FALSE(slowly.collided()) << "four times that is not half of the speed, tick " << i;
    tick(quickly, driving.losing(150));
  }
  EXPECT_TRUE(quickly.collided());
}

TEST(SlipWatch, WhereTheTracksSlipOnPurposeNothingIsStuckAndNothingTravels) {
  Drive drive;
  drive.go(0.0, 5.0, kStands);
  drive.go(150.0, 3.0, {});
  drive.go(150.0, 0.05, {0.0, 60, 3.0, 0});
  drive.go(150.0, 2.0, {0.0, 60, 0.0, 0});
  SlipWatch& watch = drive.watch;
  tick(watch, Measured::straight_on(1500));  // the first half of a step
  ASSERT_TRUE(watch.half_done());
  ASSERT_TRUE(watch.stuck());
  ASSERT_TRUE(watch.slips());
  ASSERT_TRUE(watch.collided());
  const auto states = [&] {
    return std::vector<int>(watch.network_inputs() + kSlipInputs,
                            watch.network_inputs() + kSlipInputs + kSlipUnits);
  };
  const std::vector<int> nothing(kSlipUnits, 0);
  ASSERT_NE(states(), nothing);

  pass_over(watch, Measured::straight_on(1500));
  EXPECT_FALSE(watch.stuck());
  EXPECT_FALSE(watch.slips());
  EXPECT_EQ(watch.evidence(), 0);
  EXPECT_FALSE(watch.collided());
  EXPECT_FALSE(watch.half_done());
  EXPECT_EQ(watch.travel_share(), 0);
  EXPECT_EQ(states(), nothing) << "of the network";
  tick(watch, Measured::straight_on(1500));
  EXPECT_TRUE(watch.half_done()) << "begins a step";
  for (int input = 0; input < 3; ++input) EXPECT_NEAR(watch.network_inputs()[input], 0, 1) << input;
}

TEST(SlipWatch, WhereTheTracksSlipOnPurposeNothingTravelsEvenIfAllDidBefore) {
  Drive drive;
  drive.go(0.0, 5.0, kStands);
  drive.go(150.0, 3.0, {});
  ASSERT_GT(drive.watch.travel_share(), 192);
  pass_over(drive.watch, Measured::straight_on(1500));
  EXPECT_EQ(drive.watch.travel_share(), 0);
}

TEST(SlipWatch, WhereTheTracksSlipOnPurposeCollisionsAreForgottenToo) {
  const Measured driving = Measured::straight_on(500);
  SlipWatch watch = watch_at(driving);
  tick(watch, driving.losing(900));
  ASSERT_TRUE(watch.collided());
  pass_over(watch, driving);
  tick(watch, driving.losing(450));
  EXPECT_FALSE(watch.collided()) << "nothing is left of what was lost before";
  pass_over(watch, driving);
  tick(watch, driving.losing(550));
  EXPECT_TRUE(watch.collided());
}

// So that what the belts did meanwhile is not taken for a loss: each track may have its own speed.
TEST(SlipWatch, WhereTheTracksSlipOnPurposeTheirSpeedIsStillFollowed) {
  for (const auto& [left, right] : std::initializer_list<std::pair<int16_t, int16_t>>{
           {1600, 800}, {800, 1600}, {-1600, 400}, {2000, 2000}}) {
    Measured it;
    it.left = left;
    it.right = right;
    SlipWatch watch = watch_at(it);
    tick(watch, it);
    for (int input = 0; input < 3; ++input) {
      EXPECT_EQ(watch.network_inputs()[input], 0) << left << " " << right << " input " << input;
    }
    EXPECT_FALSE(watch.collided()) << left << " " << right;
  }
}

// With tracks of 51.2 mm/s an input's unit is four of 0.1 mm/s, or eight of what is lost in a tick.
TEST(SlipWatch, WhatIsForgottenLeavesNothingToTheLossesAfterIt) {
  const Measured driving = Measured::straight_on(512);
  for (const auto& [units, input] : std::initializer_list<std::pair<int, int>>{
           {7, 0}, {8, 1}, {15, 1}, {16, 2}, {-8, -1}, {0, 0}}) {
    SlipWatch watch = watch_at(driving.losing(100));
    tick(watch, driving.losing(units));
    for (int i = 0; i < 3; ++i) EXPECT_EQ(watch.network_inputs()[i], input) << units << " " << i;
  }
}

TEST(SlipWatch, TheNetworkIsAskedFrom35MillimetresASecond) {
  SlipWatch watch(kTread_mm);
  tick(watch, Measured::straight_on(349));
  EXPECT_FALSE(watch.half_done());
  EXPECT_EQ(watch.travel_share(), 255);
  tick(watch, Measured::straight_on(350));
  EXPECT_TRUE(watch.half_done());
  tick(watch, Measured::straight_on(350), false);
  EXPECT_TRUE(watch.half_done()) << "not asked in this tick";
  tick(watch, Measured::straight_on(348));
  EXPECT_FALSE(watch.half_done()) << "a step that was begun is given up";
  EXPECT_EQ(watch.evidence(), 0);
  tick(watch, Measured::straight_on(-350));
  EXPECT_TRUE(watch.half_done()) << "and one begins anew";
}

TEST(SlipWatch, ARobotThatTurnsOnTheSpotDrivesAhead) {
  Measured turning;
  turning.left = -1000;
  turning.right = 1000;
  turning.sin_pitch_q14 = 6400;
  SlipWatch watch = watch_at(turning);
  tick(watch, turning);
  EXPECT_EQ(watch.network_inputs()[6], 100) << "nose up";
  turning.left = -1004;
  tick(watch, turning);
  tick(watch, turning);
  EXPECT_EQ(watch.network_inputs()[6], -100) << "the belts go back";
}

// Both tracks' duty, no more than 2000 of it, over eight ticks.
TEST(SlipWatch, EffortIsLimitedBeforeItIsSmoothed) {
  for (const int16_t each : std::initializer_list<int16_t>{1000, 1001, 1125, 8000}) {
    SlipWatch watch(kTread_mm);
    Measured it;
    it.left_effort = each;
    it.right_effort = each;
    tick(watch, it, false);
    it.left_effort = -750;
    it.right_effort = -750;
    tick(watch, it);
    EXPECT_EQ(watch.network_inputs()[7], (2000 - 2000 / 8 - 1500) / 8) << each;
  }
}

// 32 log2(counts / 1024), here of the first tick's counts: straight lines between the powers of
// two.
TEST(SlipWatch, VibrationIsALogarithmOfStraightLines) {
  const std::initializer_list<std::pair<int16_t, int>> expected = {
      {0, -128},  {1, -128},  {55, -128}, {57, -128},  {63, -128},  {64, -128}, {68, -126},
      {71, -125}, {72, -124}, {96, -112}, {112, -104}, {120, -100}, {127, -97}, {128, -96},
      {136, -94}, {143, -93}, {192, -80}, {240, -68},  {250, -66}};
  for (const auto& [counts, logarithm] : expected) {
    for (const int sign : {1, -1}) {
      Measured it;
      it.pitch_rate = static_cast<int16_t>(sign * counts);
      it.ahead = it.pitch_rate;
      it.up = it.pitch_rate;
      SlipWatch watch = watch_at(it);
      tick(watch, it);
      for (int input = 8; input <= 10; ++input) {
        EXPECT_EQ(watch.network_inputs()[input], logarithm) << sign * counts << " input " << input;
      }
    }
  }
}

/// A watch whose evidence a step has just brought to this number: a robot digs itself in and comes
/// free again, and what it feels in one of its steps is changed until the number is met.
std::optional<SlipWatch> watch_with_evidence(int evidence, bool stuck_before) {
  Drive drive;
  drive.go(0.0, 5.0, kStands);
  drive.go(150.0, 1.0, {});
  if (drive.watch.half_done()) drive.go(150.0, 0.02, {});
  for (int step = 0; step < 1000; ++step) {
    const bool dug_in = step % 40 < 20;
    drive.go(150.0, 0.04,
             {dug_in ? 0.0 : 1.0, static_cast<int16_t>(dug_in ? 60 : 12), dug_in ? 0.3 : -0.3, 0});
    if (drive.watch.stuck() != stuck_before) continue;
    if (std::abs(drive.watch.evidence() - evidence) > 6000) continue;
    Measured best = Measured::straight_on(1500);
    best.up = 4098;
    int least = INT_MAX;
    for (int i = 0; i < 300; ++i) {
      const auto changed = [&](int16_t value) {
        const auto reach = static_cast<int>(1U << drive.random() % 10U);
        return static_cast<int16_t>(value + (drive.random() % 2U == 0 ? reach : -reach));
      };
      Measured it = best;
      it.left = changed(it.left);
      it.right = changed(it.right);
      it.left_effort = changed(it.left_effort);
      it.pitch_rate = changed(it.pitch_rate);
      it.ahead = changed(it.ahead);
      it.up = changed(it.up);
      it.sin_pitch_q14 = changed(it.sin_pitch_q14);
      SlipWatch watch = drive.watch;
      tick(watch, it);
      tick(watch, it);
      const int distance = std::abs(watch.evidence() - evidence);
      if (distance == 0) return watch;
      if (distance > least) continue;
      least = distance;
      best = it;
    }
  }
  return std::nullopt;
}

TEST(SlipWatch, TheModelsThresholdsThemselvesCount) {
  using nn::model_slip::kFreeEvidence;
  using nn::model_slip::kSlipEvidence;
  using nn::model_slip::kStuckEvidence;
  for (const int below : {0, 1}) {
    const std::optional<SlipWatch> slipping = watch_with_evidence(kSlipEvidence - below, false);
    ASSERT_TRUE(slipping.has_value());
    EXPECT_EQ(slipping->slips(), below == 0);
    EXPECT_FALSE(slipping->stuck());
    const std::optional<SlipWatch> digging = watch_with_evidence(kStuckEvidence - below, false);
    ASSERT_TRUE(digging.has_value());
    EXPECT_EQ(digging->stuck(), below == 0);
    const std::optional<SlipWatch> coming_free = watch_with_evidence(kFreeEvidence - below, true);
    ASSERT_TRUE(coming_free.has_value());
    EXPECT_EQ(coming_free->stuck(), below == 0) << "not free yet";
  }
}

TEST(SlipWatch, ATurnThatTheGyroDoesNotSeeIsNone) {
  // 150 mm/s at the tracks turn a robot by 45 degrees/s on firm ground: half is slip.
  constexpr int32_t kTurns = 8192;
  Drive turning;
  turning.go(0.0, 5.0, kStands);
  turning.go(0.0, 3.0, {1.0, 20, 0.0, kTurns}, 150.0);
  EXPECT_FALSE(turning.watch.stuck());
  Drive dug_in;
  dug_in.go(0.0, 5.0, kStands);
  dug_in.go(0.0, 1.0, {0.0, 20, 0.0, 0}, 150.0);
  EXPECT_TRUE(dug_in.watch.stuck());
}

TEST(SlipWatch, BearsAnything) {
  std::mt19937 random(1);
  const auto any = [&] { return static_cast<int16_t>(random()); };
  SlipWatch watch(kTread_mm);
  for (int i = 0; i < 20000; ++i) {
    const int16_t extreme = i % 3 == 0 ? INT16_MIN : INT16_MAX;
    const TrackMotion left = {i % 5 == 0 ? extreme : any(), static_cast<int16_t>(any() % 801)};
    const TrackMotion right = {any(), static_cast<int16_t>(any() % 801)};
    const int16_t gyro[] = {any(), i % 7 == 0 ? extreme : any(), any()};
    const int16_t accel[] = {i % 11 == 0 ? extreme : any(), any(), i % 13 == 0 ? extreme : any()};
    watch.tick(left, right, gyro, accel, static_cast<int16_t>(any() / 2),
               static_cast<int32_t>(any()) * 16, i % 11 != 0);
    ASSERT_TRUE(!watch.stuck() || watch.slips() || watch.evidence() > 0) << i;
  }
}

TEST(SlipWatch, TheRobotsNetworkIsTheModelFiles) {
  const std::filesystem::path models = kModelsFolder;
  const std::string header = nn::slip_model_header(nn::read_slip_model(models / "slip.json"));
  std::ifstream file(models / "../../firmware/estimation/slip_model.h");
  ASSERT_TRUE(file) << "firmware/estimation/slip_model.h";
  std::ostringstream text;
  text << file.rdbuf();
  EXPECT_EQ(text.str(), header) << "screed nn slip export";
}

TEST(SlipWatch, EvidenceIsAMeanOverFourSteps) {
  EXPECT_EQ(slip_evidence(0, INT16_MIN), 0);
  EXPECT_NEAR(slip_evidence(0, INT16_MAX), 16384, 2);
  EXPECT_NEAR(slip_evidence(65535, INT16_MIN), 49151, 2);
  EXPECT_NEAR(slip_evidence(20000, 0), 23192, 2);
  std::uint16_t evidence = 0;
  for (int i = 0; i < 60; ++i) evidence = slip_evidence(evidence, INT16_MAX);
  EXPECT_GT(evidence, 65500);
}

}  // namespace
}  // namespace screed
