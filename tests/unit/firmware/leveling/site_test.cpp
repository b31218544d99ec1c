// The site: random places of it, and its fence.
#include <gtest/gtest.h>
#include <array>
#include <cmath>
#include <cstdlib>
#include <initializer_list>
#include <numbers>

#include "firmware/leveling/site.h"

namespace screed {

namespace {

// Random places of a site.

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

// The fence: where it stands, and that its motion leads home.

Parameters site(int16_t radius_mm) {
  Parameters parameters;
  parameters.site_radius() = radius_mm;
  parameters.walk_speed_max() = 100;
  return parameters;
}

/// A place that is known exactly.
Place at(int x_mm, int y_mm) {
  return {{static_cast<int16_t>(x_mm), static_cast<int16_t>(y_mm)}, {0, 0}};
}

TEST(SiteFence, EndsAtTheRadius) {
  SiteFence fence(site(1000));
  EXPECT_FALSE(fence.update(at(0, 0)));
  EXPECT_FALSE(fence.update(at(600, -800)));  // exactly on the circle
  EXPECT_FALSE(fence.outside());
  EXPECT_TRUE(fence.update(at(601, -800)));
  EXPECT_TRUE(fence.outside());
  EXPECT_FALSE(fence.update(at(0, 1000)));
  EXPECT_FALSE(fence.outside());
  EXPECT_TRUE(fence.update(at(-1001, 0)));
}

TEST(SiteFence, RadiusZeroSwitchesItOff) {
  SiteFence fence(site(0));
  EXPECT_FALSE(fence.update(at(INT16_MAX, INT16_MIN)));
}

TEST(SiteFence, SeesTheFarthestPlaces) {
  for (const int16_t radius_mm : std::initializer_list<int16_t>{1, 1000, 30000}) {
    SiteFence fence(site(radius_mm));
    EXPECT_FALSE(fence.update(at(0, 0)));
    for (const int far : {30001, INT16_MAX}) {
      EXPECT_TRUE(fence.update(at(far, 0))) << radius_mm << " " << far;
      EXPECT_TRUE(fence.update(at(0, -far))) << radius_mm << " " << far;
      EXPECT_TRUE(fence.update(at(-far, far))) << radius_mm << " " << far;
    }
  }
}

// The circle is smaller by the deviation of the worse axis, and by half at most.
TEST(SiteFence, IsNearerTheLessTheRobotKnows) {
  const auto ends_at = [](uint8_t sigma_x, uint8_t sigma_y) {
    for (int16_t x = 0;; ++x) {
      SiteFence fence(site(1000));
      if (fence.update({{x, 0}, {sigma_x, sigma_y}})) return x;
    }
  };
  EXPECT_EQ(ends_at(0, 0), 1001);
  EXPECT_EQ(ends_at(10, 0), 961) << "40 mm";
  EXPECT_EQ(ends_at(3, 25), 901) << "100 mm";
  EXPECT_EQ(ends_at(100, 0), 601) << "400 mm";
  EXPECT_EQ(ends_at(150, 0), 501) << "600 mm";
  EXPECT_EQ(ends_at(255, 255), 501);
}

// On loose ground a turn on the spot digs in: it is as short as it can be.
TEST(SiteFence, DrivesBackwardsWhereHomeLiesBehind) {
  const SiteFence fence(site(1000));
  // East of home: home lies in the west.
  EXPECT_EQ(fence.steer(-1100, 0, 0).speed_mm_per_s, -100);
  EXPECT_EQ(fence.steer(-1100, 0, 0).yaw_rate, 0);
  EXPECT_EQ(fence.steer(-1100, 0, -32768).speed_mm_per_s, 100);
  EXPECT_EQ(fence.steer(-1100, 0, -32768).yaw_rate, 0);
  // Heading north its nose turns west, heading south its tail: to either side of a quarter turn.
  EXPECT_GT(fence.steer(-1100, 0, 16384 + 10).yaw_rate, 0);
  EXPECT_LT(fence.steer(-1100, 0, 16384 - 10).yaw_rate, 0);
  // Never faster than 60 degrees/s, nor further than a quarter turn.
  for (int32_t heading = -32768; heading <= 32767; heading += 111) {
    EXPECT_LE(std::abs(fence.steer(-1100, -300, static_cast<Angle>(heading)).yaw_rate), 10923);
  }
}

TEST(SiteFence, TurnsTwiceTheErrorASecondAndDrivesWithinFortyFiveDegrees) {
  const SiteFence fence(site(1000));
  // West of home, home lies in the east: the error is minus the heading.
  for (const int error : {1, 100, 2000, 5000, -5000}) {
    EXPECT_EQ(fence.steer(1100, 0, static_cast<Angle>(-error)).yaw_rate, 2 * error) << error;
    // The tail towards home: the same turns.
    EXPECT_EQ(fence.steer(-1100, 0, static_cast<Angle>(-error)).yaw_rate, 2 * error) << error;
  }
  // 60 degrees/s are 10922.7 units.
  EXPECT_NEAR(fence.steer(1100, 0, -15000).yaw_rate, 10922.7, 1.0);
  EXPECT_NEAR(fence.steer(1100, 0, 15000).yaw_rate, -10922.7, 1.0);
  constexpr Angle kFortyFive = 8192;
  for (const int side : {1, -1}) {
    const auto heading = [&](int angle) { return static_cast<Angle>(side * angle); };
    EXPECT_EQ(fence.steer(1100, 0, heading(kFortyFive - 1)).speed_mm_per_s, 100) << side;
    EXPECT_EQ(fence.steer(1100, 0, heading(kFortyFive + 1)).speed_mm_per_s, 0) << side;
    EXPECT_EQ(fence.steer(-1100, 0, heading(kFortyFive - 1)).speed_mm_per_s, -100) << side;
  }
}

TEST(SiteFence, LeadsHomeFromEverywhere) {
  for (int degrees = 0; degrees < 360; degrees += 15) {
    for (int heading_degrees = 0; heading_degrees < 360; heading_degrees += 45) {
      SiteFence fence(site(1000));
      double x = 1100.0 * std::cos(degrees * std::numbers::pi / 180.0);
      double y = 1100.0 * std::sin(degrees * std::numbers::pi / 180.0);
      double heading = heading_degrees * 65536.0 / 360.0;
      int ticks = 0;
      const auto mm = [](double value) { return static_cast<int16_t>(std::lround(value)); };
      while (fence.update(at(mm(x), mm(y))) && ticks < 3000) {
        const MotionCommand motion =
            fence.steer(mm(-x), mm(-y), wrap_angle(static_cast<int32_t>(std::lround(heading))));
        heading += motion.yaw_rate * 0.01;
        x += motion.speed_mm_per_s * 0.01 * std::cos(heading * 2.0 * std::numbers::pi / 65536.0);
        y += motion.speed_mm_per_s * 0.01 * std::sin(heading * 2.0 * std::numbers::pi / 65536.0);
        ASSERT_LT(std::hypot(x, y), 1150.0);
        ++ticks;
      }
      // 0.1 m at 0.1 m/s and a quarter turn at up to 60 degrees/s.
      ASSERT_LT(ticks, 350) << degrees << " " << heading_degrees;
    }
  }
}

}  // namespace

}  // namespace screed
