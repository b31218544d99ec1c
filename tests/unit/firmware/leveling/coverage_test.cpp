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
  parameters.algorithm = static_cast<int16_t>(LevelingAlgorithm::kCoverage);
  parameters.coverage_half_side = half_side_mm;
  parameters.coverage_spacing = spacing_mm;
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
  std::vector<int> covered(kCells * kCells, 0);
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
  parameters.site_radius = 1000;
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

}  // namespace
}  // namespace screed
