// The map of flows against closed solutions: slant, sines and humps on a site without flow through
// its edge; the sensor's own slant; what it must not learn.
#include "firmware/leveling/flow_map.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace screed {
namespace {

constexpr double kAngleUnits = 65536.0 / (2.0 * std::numbers::pi);
constexpr int kHalf_mm = 750;
constexpr int kSide = 6;                             // cells
constexpr double kCell_mm = 2.0 * kHalf_mm / kSide;  // of which lengths are multiples here
constexpr double kPerSource = 2.71;                  // a source is that of a flow, in Angles cell^2
constexpr double kWave = std::numbers::pi / kSide;   // of one half wave over the site, 1/cell
constexpr int kSweep = kSide * kSide;                // ticks

using Vector = std::array<double, 2>;
/// Uphill slope east and north at a place in cells from the middle; Angles.
using Slopes = std::function<Vector(double, double)>;

class FlowMapLearns : public ::testing::Test {
 protected:
  static Parameters parameters() {
    Parameters parameters;
    parameters.site_x() = kHalf_mm;
    parameters.site_y() = kHalf_mm;
    return parameters;
  }

  LevelingInput at(double x, double y, double heading, Vector slope) const {
    LevelingInput input{};
    const double c = std::cos(heading);
    const double s = std::sin(heading);
    input.pitch = static_cast<Angle>(std::lround(slope[0] * c + slope[1] * s + sensor_[0]));
    input.roll = static_cast<Angle>(std::lround(-slope[0] * s + slope[1] * c + sensor_[1]));
    input.heading = wrap_angle(static_cast<int32_t>(std::lround(heading * kAngleUnits)));
    input.place.mm[kX] = static_cast<int16_t>(std::lround(x * kCell_mm));
    input.place.mm[kY] = static_cast<int16_t>(std::lround(y * kCell_mm));
    return input;
  }

  /// Comes to the middles of random cells on random headings and stays there for two sweeps.
  void roam(const Slopes& slopes, int places) {
    std::uniform_int_distribution<int> cell(0, kSide - 1);
    std::uniform_real_distribution<double> turn(-std::numbers::pi, std::numbers::pi);
    for (int i = 0; i < places; ++i) {
      const double x = cell(random_) + 0.5 - kSide / 2.0;
      const double y = cell(random_) + 0.5 - kSide / 2.0;
      const LevelingInput input = at(x, y, turn(random_), slopes(x, y));
      for (int tick = 0; tick < 100; ++tick) map_.tick(input, false);
      for (int tick = 0; tick < 2 * kSweep; ++tick) map_.tick(input, true);
    }
  }
  /// Stays until heights and flow are those of its slopes.
  void settle(const LevelingInput& input) {
    for (int tick = 0; tick < 60 * kSweep; ++tick) map_.tick(input, false);
  }
  /// Where ground has to come from, in the world's axes; without the share of what is felt there.
  Vector source(double x, double y, double heading = 0.0) {
    const LevelingInput input = at(x, y, heading, {0.0, 0.0});
    settle(input);
    int16_t from[2];
    map_.source(input, from);
    const double c = std::cos(heading);
    const double s = std::sin(heading);
    return {kPerSource * (from[0] * c - from[1] * s), kPerSource * (from[0] * s + from[1] * c)};
  }

  FlowMap map_{parameters()};
  std::minstd_rand random_{1};
  Vector sensor_{0.0, 0.0};  ///< what pitch and roll show on level ground
};

TEST_F(FlowMapLearns, ASlantIsLeveledByAFlowThatIsLargestInTheMiddle) {
  const double slant = 400.0;  // 2.2 degrees
  roam([&](double, double) { return Vector{slant, 0.0}; }, 1500);
  // Height slant x: the flow that takes it away is slant (L^2 / 4 - x^2) / 2; of cells, the mean of
  // the flows through two sides, of which an outer one has none.
  for (const double x : {-2.5, -1.5, -0.5, 0.5, 1.5, 2.5}) {
    const double expected = slant * (9.0 - x * x - 0.25) / 2.0;
    for (const double y : {-2.5, 0.5, 1.5}) {
      const Vector from = source(x, y);
      EXPECT_NEAR(from[0], expected, 0.06 * slant * 4.5) << x << " " << y;
      EXPECT_NEAR(from[1], 0.0, 0.06 * slant * 4.5) << x << " " << y;
    }
  }
}

TEST_F(FlowMapLearns, AWaveIsLeveledByTheGradientOfItsPotential) {
  const double height = 900.0;  // Angles times cells
  // h = height cos(kx) cos(ky) of the places from the south-west corner; laplace(p) = -h has
  // p = h / (2 k^2).
  const auto wave = [&](double x, double y) {
    const double a = kWave * (x + kSide / 2.0);
    const double b = kWave * (y + kSide / 2.0);
    return Vector{-height * kWave * std::sin(a) * std::cos(b),
                  -height * kWave * std::cos(a) * std::sin(b)};
  };
  roam(wave, 1500);
  for (const double x : {-1.5, -0.5, 0.5, 1.5}) {
    for (const double y : {-1.5, -0.5, 1.5}) {
      const Vector from = source(x, y);
      const Vector slope = wave(x, y);
      const double per_slope = 1.0 / (2.0 * kWave * kWave);
      // Relaxed as it is fed, a finer wave comes out a quarter smaller than a slant.
      const double largest = height * kWave * per_slope;
      EXPECT_NEAR(from[0], slope[0] * per_slope, 0.16 * largest) << x << " " << y;
      EXPECT_NEAR(from[1], slope[1] * per_slope, 0.16 * largest) << x << " " << y;
    }
  }
}

// On the far side of a hump the ground falls to the east; it has to go west all the same.
TEST_F(FlowMapLearns, AHumpDoesNotTurnTheFlowOfTheWholeSiteRound) {
  const double slant = 300.0;
  const double hump = 700.0;
  const double k = 3.0 * kWave;  // three half waves
  const auto slopes = [&](double x, double) { return Vector{slant - hump * std::sin(k * x), 0.0}; };
  roam(slopes, 1500);
  const double x = 0.5;
  ASSERT_LT(slopes(x, 0.0)[0], 0.0);
  EXPECT_GT(source(x, 0.5)[0], 0.3 * slant * (9.0 - x * x) / 2.0);
}

TEST_F(FlowMapLearns, WhatTheSensorShowsOnLevelGroundIsNoSlope) {
  sensor_ = {110.0, -60.0};  // 0.6 and -0.3 degrees
  roam([](double, double) { return Vector{0.0, 0.0}; }, 1500);
  // A slant of a tenth of that asks for a flow of 4.5 x 11 in the middle.
  for (const double heading : {0.0, 2.0, -1.2}) {
    const LevelingInput input = at(0.5, 0.5, heading, {0.0, 0.0});
    settle(input);
    int16_t from[2];
    map_.source(input, from);
    EXPECT_NEAR(kPerSource * from[0], 0.0, 50.0) << heading;
    EXPECT_NEAR(kPerSource * from[1], 0.0, 50.0) << heading;
  }
}

TEST_F(FlowMapLearns, TheSlopeThatItFeelsCountsAQuarter) {
  const LevelingInput input = at(0.5, 0.5, 1.0, {400.0, 300.0});
  settle(input);
  int16_t from[2];
  map_.source(input, from);
  EXPECT_NEAR(from[0], input.pitch / 4.0, 6.0);  // short of it by what the lag leaves
  EXPECT_NEAR(from[1], input.roll / 4.0, 6.0);
}

TEST_F(FlowMapLearns, NothingWhileItIsNotSteady) {
  const LevelingInput slope = at(0.5, 0.5, 0.0, {900.0, 0.0});
  for (int tick = 0; tick < 10000; ++tick) map_.tick(slope, false);
  const Vector from = source(0.5, 0.5);
  EXPECT_NEAR(from[0], 0.0, 12.0);
  EXPECT_NEAR(from[1], 0.0, 12.0);
}

TEST_F(FlowMapLearns, TheSourceTurnsAgainstTheRobot) {
  roam([](double, double) { return Vector{300.0, 200.0}; }, 1500);
  const Vector straight = source(0.5, -0.5);
  for (const double heading : {0.7, 3.0, -1.5}) {
    const Vector turned = source(0.5, -0.5, heading);
    EXPECT_NEAR(turned[0], straight[0], 20.0) << heading;
    EXPECT_NEAR(turned[1], straight[1], 20.0) << heading;
  }
}

TEST_F(FlowMapLearns, OutsideTheSiteIsItsEdge) {
  roam([](double, double) { return Vector{300.0, 200.0}; }, 1500);
  const Vector edge = source(2.9, 2.9);
  for (const double far : {3.1, 40.0, 130.0}) {
    const Vector beyond = source(far, far);
    EXPECT_NEAR(beyond[0], edge[0], 4.0) << far;
    EXPECT_NEAR(beyond[1], edge[1], 4.0) << far;
  }
}

// Steeper than it can stand: numbers may be wrong then, but the next slopes put them right.
TEST_F(FlowMapLearns, NonsenseDoesNotLast) {
  std::uniform_int_distribution<int> any(INT16_MIN, INT16_MAX);
  for (int i = 0; i < 20000; ++i) {
    LevelingInput input{};
    input.pitch = static_cast<Angle>(any(random_));
    input.roll = static_cast<Angle>(any(random_));
    input.heading = static_cast<Angle>(any(random_));
    input.place.mm[kX] = static_cast<int16_t>(any(random_));
    input.place.mm[kY] = static_cast<int16_t>(any(random_));
    map_.tick(input, true);
  }
  roam([](double, double) { return Vector{300.0, 0.0}; }, 3000);
  EXPECT_NEAR(source(0.5, 0.5)[0], 300.0 * 8.5 / 2.0, 200.0);
}

}  // namespace
}  // namespace screed
