// Strokes: on a slope the robot faces straight up or down it and rocks, gently into the way down
// and at once into the way up; the limit of what is worth it follows from what there is.
#include "firmware/leveling/strokes.h"

#include <gtest/gtest.h>

#include <algorithm>
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
    parameters.algorithm = static_cast<int16_t>(LevelingAlgorithm::kStrokes);
    parameters.site_radius = 1200;
    parameters.site_x = kHalf_mm;
    parameters.site_y = kHalf_mm;
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
  double limit_deg() const { return strokes_.limit() / kAngleUnits / kDegree; }

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

TEST_F(StrokesOnAPlane, WorksStraightUpOrDownTheSlopeAndBeginsDownhill) {
  slope_deg_ = 12.0;
  for (const double uphill_deg : {0.0, 70.0, 180.0, -120.0}) {
    uphill_deg_ = uphill_deg;
    drive(90);
  }
  ASSERT_GE(works_, 8);
  for (size_t i = 0; i < facing_.size(); ++i) {
    EXPECT_GT(std::abs(std::cos(facing_[i])), std::cos(14.0 * kDegree)) << i;
    // Downhill is against the way uphill.
    EXPECT_LT(first_speed_[i] * std::cos(facing_[i]), -29.0) << i;
  }
  // The tracks go further uphill than down: that makes up for the slip.
  EXPECT_GT(uphill_mm_, 0.2 * 250.0 * stroke_ticks_ / kTickRate_hz);
}

TEST_F(StrokesOnAPlane, EasesIntoTheWayDownAndTurnsUphillAtOnce) {
  slope_deg_ = 12.0;
  drive_until_it_strokes();
  while (uphill_speed_.size() < 84) tick();
  for (int i = 0; i < 84; ++i) {
    const int of_cycle = i % 42;  // 0.18 s down, 0.24 s up
    const int from = i < 42 ? 0 : 250;
    const int expected = of_cycle >= 18 ? 250 : std::max(-250, from - 30 * (of_cycle + 1));
    EXPECT_EQ(uphill_speed_[static_cast<size_t>(i)], expected) << i;
  }
}

TEST_F(StrokesOnAPlane, OnLevelGroundItOnlyDrivesAndItsLimitFalls) {
  const double first = limit_deg();
  drive(600);
  EXPECT_EQ(works_, 0);
  EXPECT_NEAR(limit_deg(), 2.0, 0.05);
  EXPECT_GT(first, 7.0);
  // It comes near all walls.
  EXPECT_GT(farthest_mm_, kHalf_mm - 220);
  // Its places are 115 mm from them; past one it turns in an arc, which only a wall would hold up.
  EXPECT_LE(farthest_mm_, kHalf_mm - 80);
}

TEST_F(StrokesOnAPlane, TheLimitRisesWithWorkSoThatTheSteepestGoesFirst) {
  slope_deg_ = 15.0;
  const double before = limit_deg();
  drive(120);
  EXPECT_GT(limit_deg(), before);
  EXPECT_LT(limit_deg(), 15.0);
  // What was worth it then is so no more.
  slope_deg_ = 0.3 * limit_deg();  // what it is at ends
  drive(1);
  ASSERT_FALSE(strokes_now());
  slope_deg_ = 0.8 * limit_deg();
  works_ = 0;
  for (int i = 0; i < 4 * kTickRate_hz && works_ == 0; ++i) tick();
  EXPECT_EQ(works_, 0);
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

TEST_F(StrokesOnAPlane, StopsWhereTheSlopeIsGone) {
  slope_deg_ = 12.0;
  drive_until_it_strokes();
  slope_deg_ = 1.0;
  drive(1);
  EXPECT_FALSE(strokes_now());
  // And on a slope that stays, in the end.
  slope_deg_ = 12.0;
  drive_until_it_strokes();
  int ticks = 0;
  for (; strokes_now() && ticks < 3000; ++ticks) tick();
  EXPECT_NEAR(ticks, 1600, 40);
}

}  // namespace
}  // namespace screed
