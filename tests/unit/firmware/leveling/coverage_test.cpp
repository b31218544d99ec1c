// Coverage in parallel lines: a point that moves as commanded leaves no strip of its square out.
#include "firmware/leveling/coverage.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "firmware/leveling/leveling.h"

namespace screed {
namespace {

constexpr double kAngleUnits = 65536.0 / (2.0 * std::numbers::pi);

Parameters coverage_parameters(int16_t half_side_mm, int16_t spacing_mm) {
  Parameters parameters;
  parameters.algorithm() = static_cast<int16_t>(LevelingAlgorithm::kCoverage);
  parameters.coverage_half_side() = half_side_mm;
  parameters.coverage_spacing() = spacing_mm;
  return parameters;
}

/// Moves exactly as commanded, in mm.
struct Point {
  void tick(Leveling& leveling) {
    const auto heading = wrap_angle(static_cast<int32_t>(std::lround(angle * kAngleUnits)));
    const MotionCommand motion = leveling.tick(
        {0,
         heading,
         {{static_cast<int16_t>(std::lround(x)), static_cast<int16_t>(std::lround(y))}, {0, 0}},
         {0, 0}});
    angle += motion.yaw_rate / kAngleUnits / kTickRate_hz;
    x += motion.speed_mm_per_s * std::cos(angle) / kTickRate_hz;
    y += motion.speed_mm_per_s * std::sin(angle) / kTickRate_hz;
  }

  double x = 0.0;
  double y = 0.0;
  double angle = 1.0;
};

TEST(Coverage, LeavesNoStripOfItsSquareOut) {
  constexpr int kHalf_mm = 500;
  constexpr int kCell_mm = 50;
  constexpr int kCells = 2 * kHalf_mm / kCell_mm;
  Leveling leveling(coverage_parameters(kHalf_mm, 200));
  leveling.start();
  Point point;
  std::vector<int> covered(size_t{kCells} * kCells, 0);
  double farthest = 0.0;
  for (int tick = 0; tick < 240 * kTickRate_hz; ++tick) {
    point.tick(leveling);
    ASSERT_EQ(leveling.state(), LevelingState::kCover);
    farthest = std::max({farthest, std::abs(point.x), std::abs(point.y)});
    // The robot is wider than half a spacing to either side.
    for (int row = 0; row < kCells; ++row) {
      for (int column = 0; column < kCells; ++column) {
        const double dx = (column + 0.5) * kCell_mm - kHalf_mm - point.x;
        const double dy = (row + 0.5) * kCell_mm - kHalf_mm - point.y;
        if (std::hypot(dx, dy) < 110.0)
          covered.at(static_cast<size_t>(row) * kCells + static_cast<size_t>(column)) = 1;
      }
    }
  }
  int cells = 0;
  for (const int one : covered) cells += one;
  EXPECT_GT(cells, kCells * kCells * 97 / 100);
  EXPECT_LT(farthest, kHalf_mm + 100);
}

TEST(Coverage, ErrorsAcrossTheLineDieAway) {
  Leveling leveling(coverage_parameters(3000, 200));
  leveling.start();
  Point point;
  point.y = -120.0;
  point.angle = 2.5;
  while (point.x < 1500.0) point.tick(leveling);
  EXPECT_NEAR(point.y, 0.0, 10.0);
  EXPECT_NEAR(std::remainder(point.angle, std::numbers::pi), 0.0, 0.05) << "ahead or backwards";
}

TEST(Coverage, TheFenceEndsALine) {
  Parameters parameters = coverage_parameters(30000, 200);
  parameters.site_radius() = 1000;
  Leveling leveling(parameters);
  leveling.start();
  Point point;
  bool returned = false;
  for (int tick = 0; tick < 20 * kTickRate_hz && !returned; ++tick) {
    point.tick(leveling);
    returned = leveling.state() == LevelingState::kReturn;
  }
  ASSERT_TRUE(returned);
  while (leveling.state() == LevelingState::kReturn) point.tick(leveling);
  // The next line, westward.
  double west = point.x;
  for (int tick = 0; tick < 10 * kTickRate_hz; ++tick) {
    point.tick(leveling);
    west = std::min(west, point.x);
  }
  EXPECT_LT(west, -300.0);
  EXPECT_NEAR(point.y, 200.0, 30.0);
}

TEST(Coverage, ASquareNarrowerThanTheSpacingIsOneLine) {
  Leveling leveling(coverage_parameters(150, 2000));
  leveling.start();
  Point point;
  for (int tick = 0; tick < 60 * kTickRate_hz; ++tick) {
    point.tick(leveling);
    ASSERT_LT(std::abs(point.y), 150.0);
    ASSERT_LT(std::abs(point.x), 300.0);
  }
}

/// A robot that is put anywhere and faces east.
class CoverageByHand : public ::testing::Test {
 protected:
  MotionCommand at(int x, int y) {
    LevelingInput input{};
    input.place.mm[kX] = static_cast<int16_t>(x);
    input.place.mm[kY] = static_cast<int16_t>(y);
    return coverage_.tick(input, behaviour_);
  }
  /// It drives straight on there, so this is its line; eastward positive.
  void expect_line(int y, int way) {
    const MotionCommand on_it = at(0, y);
    EXPECT_EQ(on_it.yaw_rate, 0) << y;
    EXPECT_EQ(on_it.speed_mm_per_s, 160 * way) << y;
    // To the left of it, it steers back to the right, and that is to the left on its way backwards.
    EXPECT_LT(at(0, y + 10).yaw_rate * way, 0) << y;
    EXPECT_GT(at(0, y - 10).yaw_rate * way, 0) << y;
  }

  Coverage coverage_{coverage_parameters(400, 200)};
  Behaviour behaviour_{coverage_parameters(400, 200)};
};

TEST_F(CoverageByHand, GoesToAndFroBetweenTheEdgesOfTheSquareTheLastLinesOnThem) {
  int way = 1;
  for (const int line : {0, 200, 400, 200, 0, -200, -400, -200, 0, 200, 400, 200}) {
    expect_line(line, way);
    at(401 * way, line);
    way = -way;
  }
}

TEST_F(CoverageByHand, ALineEndsBeyondTheEdge) {
  at(400, 0);
  expect_line(0, 1);
  at(401, 0);
  expect_line(200, -1);
  at(401, 200);
  at(-400, 200);
  expect_line(200, -1);
  at(-401, 200);
  expect_line(400, 1);
}

TEST_F(CoverageByHand, SteersForAPoint80mmAhead) {
  constexpr double kDegree = 65536.0 / 360.0;
  EXPECT_NEAR(at(0, -40).yaw_rate / kDegree, 2 * 26.565, 0.1);  // atan(40 / 80), twice a second
  EXPECT_NEAR(at(0, 20).yaw_rate / kDegree, -2 * 14.036, 0.1);
  at(401, 0);
  EXPECT_NEAR(at(0, 160).yaw_rate / kDegree, -2 * 26.565, 0.1);
}

TEST_F(CoverageByHand, AnEscapeEndsALine) {
  at(0, 0);
  behaviour_.enter_or_stay(LevelingState::kEscape, {0, 0});
  expect_line(200, -1);
}

}  // namespace
}  // namespace screed
