// Random places of a site.
#include "firmware/leveling/site_rectangle.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>

namespace screed {
namespace {

constexpr int16_t kFromEdge_mm = 115;
constexpr int kDraws = 4000;
constexpr int kQuarter = kDraws / 4;

class SitePlaces : public ::testing::Test {
 protected:
  static Parameters parameters() {
    Parameters parameters;
    parameters.site_radius() = 3000;
    parameters.site_x() = 750;
    parameters.site_y() = 500;
    return parameters;
  }
  static constexpr int kReach_mm[2] = {750 - kFromEdge_mm, 500 - kFromEdge_mm};

  Random random_{7};
  SiteRectangle site_{parameters()};
};

TEST_F(SitePlaces, AnywhereAreSpreadOverTheSite) {
  std::array<int, 4> quarters{};
  double squares[2] = {0.0, 0.0};
  for (int i = 0; i < kDraws; ++i) {
    int16_t mm[2];
    site_.draw_place(random_, kFromEdge_mm, mm);
    for (const uint8_t axis : {kX, kY}) {
      ASSERT_LE(std::abs(mm[axis]), kReach_mm[axis]);
      squares[axis] += static_cast<double>(mm[axis]) * mm[axis];
    }
    const size_t west = mm[kX] < 0 ? 1 : 0;
    const size_t south = mm[kY] < 0 ? 2 : 0;
    ++quarters[west + south];
  }
  // A quarter of 4000 is 1000 +- 27; of a uniform distribution the square's mean is a third.
  for (const int count : quarters) EXPECT_NEAR(count, kQuarter, 110);
  for (const uint8_t axis : {kX, kY}) {
    EXPECT_NEAR(squares[axis] / kDraws / kReach_mm[axis] / kReach_mm[axis], 1.0 / 3.0, 0.02);
  }
}

TEST_F(SitePlaces, AtTheEdgeLieOnAllFourSidesAllAlong) {
  std::array<int, 4> sides{};
  double squares[2] = {0.0, 0.0};
  std::array<int, 2> along{};
  for (int i = 0; i < kDraws; ++i) {
    int16_t mm[2];
    site_.draw_place_at_edge(random_, kFromEdge_mm, mm);
    const bool east_or_west = std::abs(mm[kX]) == kReach_mm[kX];
    ASSERT_TRUE(east_or_west || std::abs(mm[kY]) == kReach_mm[kY]) << mm[kX] << ' ' << mm[kY];
    const uint8_t side = east_or_west ? kX : kY;
    const uint8_t other = side == kX ? kY : kX;
    ASSERT_LE(std::abs(mm[other]), kReach_mm[other]);
    const size_t far = mm[side] < 0 ? 2 : 0;
    ++sides[side + far];
    ++along[other];
    squares[other] += static_cast<double>(mm[other]) * mm[other];
  }
  for (const int count : sides) EXPECT_NEAR(count, kQuarter, 110);
  for (const uint8_t axis : {kX, kY}) {
    EXPECT_NEAR(squares[axis] / along[axis] / kReach_mm[axis] / kReach_mm[axis], 1.0 / 3.0, 0.03);
  }
}

}  // namespace
}  // namespace screed
