// Strokes: the robot faces where ground has to come from, or turns its back on it, and rocks,
// gently away from there and at once towards it; the limit of what is worth it follows from what
// there is.
#include "firmware/leveling/strokes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "firmware/leveling/leveling.h"

namespace screed {
namespace {

constexpr double kAngleUnits = 65536.0 / (2.0 * std::numbers::pi);
constexpr double kDegree = std::numbers::pi / 180.0;
constexpr int kHalf_mm = 750;

/// A plane, and a point on it that moves exactly as commanded.
class StrokesOnAPlane : public ::testing::Test {
 protected:
  static Parameters parameters() {
    Parameters parameters;
    parameters.algorithm() = static_cast<int16_t>(LevelingAlgorithm::kStrokes);
    parameters.site_radius() = 1200;
    parameters.site_x() = kHalf_mm;
    parameters.site_y() = kHalf_mm;
    return parameters;
  }

  void tick() {
    const double rise = std::tan(slope_deg_ * kDegree);
    const double toward = uphill_deg_ * kDegree - angle_;
    LevelingInput input{};
    input.pitch = to_units(std::atan(rise * std::cos(toward)));
    input.roll = to_units(std::atan(rise * std::sin(toward)));
    input.heading = to_units(angle_);
    input.place.mm[kX] = static_cast<int16_t>(std::lround(x_));
    input.place.mm[kY] = static_cast<int16_t>(std::lround(y_));
    const bool worked = strokes_now();
    motion_ = strokes_.tick(input, behaviour_);
    if (strokes_now()) {
      if (!worked) {
        ++works_;
        facing_.push_back(toward);
        first_speed_.push_back(motion_.speed_mm_per_s);
        uphill_speed_.clear();
      }
      uphill_speed_.push_back(motion_.speed_mm_per_s * (std::cos(toward) > 0.0 ? 1 : -1));
      ++stroke_ticks_;
      uphill_mm_ += motion_.speed_mm_per_s * std::cos(toward) / kTickRate_hz;
    }
    angle_ += motion_.yaw_rate / kAngleUnits / kTickRate_hz;
    if (strokes_now()) return;  // it slips, and stays where it is
    x_ += motion_.speed_mm_per_s * std::cos(angle_) / kTickRate_hz;
    y_ += motion_.speed_mm_per_s * std::sin(angle_) / kTickRate_hz;
    farthest_mm_ = std::max({farthest_mm_, std::abs(x_), std::abs(y_)});
  }
  void drive(int seconds) {
    for (int i = 0; i < seconds * kTickRate_hz; ++i) tick();
  }
  void drive_until_it_strokes() {
    for (int i = 0; i < 60 * kTickRate_hz && !strokes_now(); ++i) tick();
    ASSERT_TRUE(strokes_now());
  }
  bool strokes_now() const { return behaviour_.state() == LevelingState::kStroke; }
  double slope_deg_ = 0.0;
  double uphill_deg_ = 0.0;
  double x_ = 0.0;
  double y_ = 0.0;
  double angle_ = 0.0;
  Strokes strokes_{parameters()};
  Behaviour behaviour_{parameters()};
  MotionCommand motion_{};
  int works_ = 0;
  int stroke_ticks_ = 0;
  double uphill_mm_ = 0.0;
  double farthest_mm_ = 0.0;
  std::vector<double> facing_;  ///< uphill from where it faces, rad
  std::vector<int> first_speed_;
  std::vector<int> uphill_speed_;  ///< of every tick of a work

 private:
  static Angle to_units(double angle) {
    return static_cast<Angle>(
        std::lround(std::remainder(angle, 2 * std::numbers::pi) * kAngleUnits));
  }
};

class StrokesOnASlant : public StrokesOnAPlane, public ::testing::WithParamInterface<double> {};

// A plane that rises along an axis asks for a flow straight down it.
TEST_P(StrokesOnASlant, WorksStraightUpOrDownAndBeginsDownhill) {
  slope_deg_ = 3.0;
  uphill_deg_ = GetParam();
  drive(900);
  ASSERT_GE(works_, 8);
  int straight = 0;
  for (size_t i = 0; i < facing_.size(); ++i) {
    straight += std::abs(std::cos(facing_[i])) > std::cos(20.0 * kDegree) ? 1 : 0;
    // Downhill is against the way uphill.
    EXPECT_LT(first_speed_[i] * std::cos(facing_[i]), 0.0) << i;
  }
  EXPECT_GE(straight, works_ - 2) << "while it learns the slant";
}

INSTANTIATE_TEST_SUITE_P(, StrokesOnASlant, ::testing::Values(0.0, 90.0, 180.0, -90.0));

TEST_F(StrokesOnAPlane, EasesIntoTheWayDownAndTurnsUphillAtOnce) {
  slope_deg_ = 12.0;
  drive_until_it_strokes();
  while (uphill_speed_.size() < 76) tick();
  for (int i = 0; i < 76; ++i) {
    const int of_cycle = i % 38;  // 0.18 s down, 0.2 s up
    const int from = i < 38 ? 0 : 250;
    const int expected = of_cycle >= 18 ? 250 : std::max(-250, from - 30 * (of_cycle + 1));
    EXPECT_EQ(uphill_speed_[static_cast<size_t>(i)], expected) << i;
  }
}

TEST_F(StrokesOnAPlane, OnLevelGroundItOnlyDrivesAndItsLimitFalls) {
  drive(600);
  EXPECT_EQ(works_, 0);
  EXPECT_EQ(strokes_.limit(), 352);
  // It comes near all walls.
  EXPECT_GT(farthest_mm_, kHalf_mm - 220);
  // Its places are 115 mm from them; past one it turns in an arc, which only a wall would hold up.
  EXPECT_LE(farthest_mm_, kHalf_mm - 80);
}

// A place that the fence, a wall or another robot keeps it from is given up.
TEST_F(StrokesOnAPlane, WhatCameBetweenEndsTheJourney) {
  drive(1);
  const int16_t before = motion_.yaw_rate;
  int others = 0;
  for (int i = 0; i < 10; ++i) {
    behaviour_.enter_or_stay(LevelingState::kReturn, {0, 0});
    tick();
    if (motion_.yaw_rate != before) ++others;
  }
  EXPECT_GE(others, 5);
}

TEST_F(StrokesOnAPlane, GoesOnAheadAfterAWorkAndWorksThere) {
  slope_deg_ = 12.0;
  do {  // until one ends with room ahead
    drive_until_it_strokes();
    while (strokes_now()) tick();
  } while (std::max(std::abs(x_), std::abs(y_)) > kHalf_mm - 260);
  const double x = x_;
  const double y = y_;
  const double angle = angle_;
  int ticks = 0;
  for (; !strokes_now() && ticks < 300; ++ticks) tick();
  EXPECT_LE(ticks, 100);
  const double ahead = (x_ - x) * std::cos(angle) + (y_ - y) * std::sin(angle);
  EXPECT_NEAR(ahead, 118, 10) << "0.6 s at 0.2 m/s";
  EXPECT_NEAR(std::hypot(x_ - x, y_ - y), ahead, 5);
}

/// A robot that is held at a place, on a slope as told; it does not turn either.
class StrokesHeld : public ::testing::Test {
 protected:
  static Parameters parameters() {
    Parameters parameters;
    parameters.algorithm() = static_cast<int16_t>(LevelingAlgorithm::kStrokes);
    parameters.site_x() = kHalf_mm;
    parameters.site_y() = kHalf_mm;
    return parameters;
  }

  void begin_anew() {
    strokes_ = Strokes{parameters()};
    behaviour_ = Behaviour{parameters()};
    input_ = {};
  }
  /// Uphill is so far to the left of where it faces.
  void lean(double slope_deg, double uphill_deg) {
    input_.pitch = units(slope_deg * std::cos(uphill_deg * kDegree));
    input_.roll = units(slope_deg * std::sin(uphill_deg * kDegree));
  }
  static Angle units(double degrees) {
    return static_cast<Angle>(std::lround(degrees * kDegree * kAngleUnits));
  }
  void tick() { motion_ = strokes_.tick(input_, behaviour_); }
  void ticks(int count) {
    for (int i = 0; i < count; ++i) tick();
  }
  /// It falls with every journey that ends and rises with every work that begins.
  int ticks_until_the_limit_changes() {
    const Angle before = strokes_.limit();
    int count = 0;
    while (strokes_.limit() == before && count < 3000) {
      tick();
      ++count;
    }
    return count;
  }
  int ticks_until_it_strokes() {
    int count = 0;
    while (!strokes_now() && count < 3000) {
      tick();
      ++count;
    }
    return count;
  }
  /// From the present one on, which strokes.
  int ticks_of_the_work() {
    int count = 0;
    while (strokes_now() && count < 3000) {
      tick();
      ++count;
    }
    return count;
  }
  /// Would its journey end there?
  bool arrives_at(int x, int y) const {
    Strokes strokes = strokes_;
    Behaviour behaviour = behaviour_;
    LevelingInput input = input_;
    input.place.mm[kX] = static_cast<int16_t>(x);
    input.place.mm[kY] = static_cast<int16_t>(y);
    strokes.tick(input, behaviour);
    return strokes.limit() < strokes_.limit();
  }
  bool strokes_now() const { return behaviour_.state() == LevelingState::kStroke; }
  /// Where ground has to come from, ahead and left, as the last tick saw it.
  std::array<int16_t, 2> source() const {
    int16_t from[2];
    strokes_.map().source(input_, from);
    return {from[0], from[1]};
  }
  double flow() const { return std::hypot(source()[0], source()[1]); }
  double least_flow() const { return strokes_.limit() / 16.0; }
  /// So that this share of the least flow comes from ahead, or from behind where it is negative.
  void lean_for(double share) {
    input_.roll = 0;
    for (int i = 0; i < 400; ++i) {
      input_.pitch =
          static_cast<Angle>(std::lround(input_.pitch + (share * least_flow() - source()[0]) / 8));
      tick();
      if (!strokes_now()) return;
    }
  }
  double turn_deg_per_s() const { return motion_.yaw_rate / kAngleUnits / kDegree; }

  Strokes strokes_{parameters()};
  Behaviour behaviour_{parameters()};
  LevelingInput input_{};
  MotionCommand motion_{};
};

TEST_F(StrokesHeld, AJourneyEndsAfterTwelveSecondsAndTheLimitFallsByAnEighth) {
  EXPECT_EQ(strokes_.limit(), 10880);
  for (const int expected : {9520, 8330, 7289}) {
    EXPECT_EQ(ticks_until_the_limit_changes(), 12 * kTickRate_hz);
    EXPECT_EQ(strokes_.limit(), expected);
  }
}

TEST_F(StrokesHeld, ANewOneHasAJourneyBeforeItsFirstTick) {
  behaviour_.enter_or_stay(LevelingState::kWalk, {0, 0});
  EXPECT_EQ(ticks_until_the_limit_changes(), 12 * kTickRate_hz);
}

TEST_F(StrokesHeld, ArrivesWithin40mmOfAPlaceThatIs115mmFromAWall) {
  for (int journey = 0; journey < 8; ++journey) {
    behaviour_.enter_or_stay(LevelingState::kReturn, {0, 0});
    tick();
    int x = -675;
    int y = -675;
    while (!arrives_at(x, y) && y <= 675) {
      x += 75;
      if (x <= 675) continue;
      x = -675;
      y += 75;
    }
    ASSERT_TRUE(arrives_at(x, y)) << journey;
    while (arrives_at(x - 1, y)) --x;
    while (arrives_at(x, y - 1)) --y;
    x += 39;
    y += 39;
    EXPECT_EQ(std::max(std::abs(x), std::abs(y)), kHalf_mm - 115) << journey;
    for (const int away : {-39, 39}) {
      EXPECT_TRUE(arrives_at(x + away, y)) << journey;
      EXPECT_TRUE(arrives_at(x, y + away)) << journey;
    }
    for (const int away : {-200, -40, 40, 200}) {
      EXPECT_FALSE(arrives_at(x + away, y)) << journey;
      EXPECT_FALSE(arrives_at(x, y + away)) << journey;
    }
  }
}

TEST_F(StrokesHeld, TravelsForHalfASecondBeforeItWorks) {
  lean(20.0, 0.0);
  EXPECT_EQ(ticks_until_it_strokes(), kTickRate_hz / 2 + 1);
}

TEST_F(StrokesHeld, AFlowCountsWhicheverWayItLiesAndTheLimitRisesBySixtyFourth) {
  for (const double uphill_deg : {0.0, 45.0, 90.0, 120.0, 180.0, -150.0, -90.0, -30.0}) {
    begin_anew();
    ticks(60);
    double slope_deg = 0.0;
    double before = flow();
    while (strokes_.limit() == 10880 && slope_deg < 20.0) {
      before = flow();
      slope_deg += 0.02;
      lean(slope_deg, uphill_deg);
      tick();
    }
    EXPECT_LE(before, 681.01) << uphill_deg;
    EXPECT_GT(flow(), 679.0) << uphill_deg;
    EXPECT_EQ(strokes_.limit(), 10880 + 170) << uphill_deg;
  }
}

TEST_F(StrokesHeld, TurnsTheShorterWayByTwiceTheAngleASecond) {
  struct Case {
    double uphill_deg;
    double turn_deg_per_s;
  };
  for (const Case& one :
       {Case{20, 40}, Case{-30, -60}, Case{60, 90}, Case{-80, -90},  // to face uphill
        Case{160, -40}, Case{-150, 60}, Case{110, -90}, Case{-130, 90}}) {
    begin_anew();
    lean(20.0, one.uphill_deg);
    EXPECT_EQ(ticks_until_the_limit_changes(), 51) << one.uphill_deg;
    EXPECT_EQ(behaviour_.state(), LevelingState::kWalk) << one.uphill_deg;
    EXPECT_EQ(motion_.speed_mm_per_s, 0) << one.uphill_deg;
    EXPECT_NEAR(turn_deg_per_s(), one.turn_deg_per_s, 0.5) << one.uphill_deg;
  }
}

TEST_F(StrokesHeld, FacesTheSlopeWithinTenDegrees) {
  for (const double straight : {0.0, 180.0}) {
    for (const int side : {-1, 1}) {
      begin_anew();
      lean(20.0, straight + 9.6 * side);
      ticks(51);
      EXPECT_TRUE(strokes_now()) << straight << " " << side;
      begin_anew();
      lean(20.0, straight + 10.5 * side);
      ticks(100);
      EXPECT_FALSE(strokes_now()) << straight << " " << side;
      EXPECT_EQ(strokes_.limit(), 10880 + 170) << "it turns";
    }
  }
}

// What it does not come to face is worked on all the same: one time to and fro, if nothing comes
// from ahead.
TEST_F(StrokesHeld, TurnsForThreeSecondsAtMost) {
  lean(20.0, 90.0);
  ASSERT_EQ(ticks_until_the_limit_changes(), 51);
  EXPECT_EQ(ticks_until_it_strokes(), 3 * kTickRate_hz);
  EXPECT_EQ(motion_.speed_mm_per_s, -30);
  EXPECT_EQ(ticks_of_the_work(), 38);
}

TEST_F(StrokesHeld, WorksFor16SecondsAndToTheEndOfACycleForwardsAsBackwards) {
  for (const int uphill : {1, -1}) {
    begin_anew();
    lean(20.0, uphill > 0 ? 0.0 : 180.0);
    EXPECT_EQ(ticks_until_it_strokes(), 51) << uphill;
    EXPECT_EQ(motion_.speed_mm_per_s, -30 * uphill);
    int forwards = 0;
    int count = 0;
    while (strokes_now() && count < 3000) {
      EXPECT_EQ(motion_.yaw_rate, 0);
      forwards += motion_.speed_mm_per_s == 250 * uphill ? 1 : 0;
      ++count;
      tick();
    }
    EXPECT_EQ(count, 43 * 38);
    EXPECT_EQ(forwards, 43 * 20);
    EXPECT_EQ(behaviour_.state(), LevelingState::kWalk);
    EXPECT_EQ(motion_.speed_mm_per_s, 0);
    EXPECT_EQ(motion_.yaw_rate, 0);
    tick();
    EXPECT_EQ(motion_.speed_mm_per_s, 200) << "on to the next of the row, whichever way it faces";
    EXPECT_EQ(motion_.yaw_rate, 0);
  }
}

TEST_F(StrokesHeld, AWorkEndsBelowHalfOfTheLimit) {
  for (const double way : {1.0, -1.0}) {
    for (const double share : {0.45, 0.55, 0.9}) {
      begin_anew();
      lean(20.0, way > 0 ? 0.0 : 180.0);
      ASSERT_LT(ticks_until_it_strokes(), 100);
      lean_for(way * share);
      if (share < 0.5) {
        EXPECT_FALSE(strokes_now()) << way;
      } else {
        EXPECT_TRUE(strokes_now()) << way << " " << share;
        EXPECT_NEAR(source()[0], way * share * least_flow(), 8.0) << "the test's own";
      }
    }
  }
}

TEST_F(StrokesHeld, AFlowThatHasTurnedRoundEndsTheWork) {
  lean(20.0, 0.0);
  ASSERT_LT(ticks_until_it_strokes(), 100);
  lean_for(-2.0);
  EXPECT_FALSE(strokes_now());
}

TEST_F(StrokesHeld, ARowEndsNearTheEdge) {
  input_.place.mm[kX] = kHalf_mm - 115;
  for (const int beyond : {0, 1}) {
    begin_anew();
    input_.place.mm[kX] = static_cast<int16_t>(kHalf_mm - 115 + beyond);
    input_.place.mm[kY] = -200;
    lean(20.0, 0.0);
    ASSERT_LT(ticks_until_it_strokes(), 100);
    EXPECT_EQ(ticks_of_the_work(), 43 * 38);
    tick();
    EXPECT_EQ(motion_.speed_mm_per_s == 200 && motion_.yaw_rate == 0, beyond == 0);
  }
}

// Where a wall is ahead it would dig itself in, working at one place again and again.
TEST_F(StrokesHeld, FromTheEdgeItTravelsForTwoSecondsToAnotherPlace) {
  input_.place.mm[kX] = kHalf_mm - 114;
  lean(20.0, 0.0);
  ASSERT_LT(ticks_until_it_strokes(), 100);
  ticks_of_the_work();
  EXPECT_NEAR(ticks_until_it_strokes(), 2 * kTickRate_hz, 2);
}

TEST_F(StrokesHeld, AnEscapeEndsTheWorkAndAJourneyBegins) {
  lean(20.0, 0.0);
  ticks_until_it_strokes();
  ticks(100);
  ASSERT_TRUE(strokes_now());
  behaviour_.enter_or_stay(LevelingState::kEscape, {0, 0});
  tick();
  EXPECT_EQ(behaviour_.state(), LevelingState::kWalk);
  EXPECT_EQ(ticks_until_it_strokes(), 50);
  // The time of a journey begins anew as well.
  begin_anew();
  ticks(1100);
  behaviour_.enter_or_stay(LevelingState::kReturn, {0, 0});
  EXPECT_EQ(ticks_until_the_limit_changes(), 12 * kTickRate_hz);
}

}  // namespace
}  // namespace screed
