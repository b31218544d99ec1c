// The position: dead reckoning, its deviation, and the walls that correct it.
#include <gtest/gtest.h>
#include <cmath>
#include <numbers>

#include "boards/a_star_32u4/board.h"
#include "firmware/estimation/position_estimate.h"
#include "firmware/math/units.h"

namespace screed {

namespace {

// Dead reckoning on paths whose end is known, its deviation, and measurements that correct it.

constexpr uint16_t kCount_um_q4 = 9048;
constexpr double kCount_mm = 9048.0 / 16000.0;

Place place_of(const PositionEstimate& position) {
  Place place;
  position.get(place);
  return place;
}

TEST(PositionEstimate, StraightOnInEveryDirection) {
  for (const int degrees : {0, 45, 90, 135, 180, -60}) {
    PositionEstimate position(kCount_um_q4, 0);
    const auto heading = wrap_angle(degrees * 65536 / 360);
    for (int tick = 0; tick < 1000; ++tick) position.update(3, 3, heading, 0, 255);
    const double length = 3000 * kCount_mm;
    EXPECT_NEAR(position.mm(kX), length * std::cos(degrees * std::numbers::pi / 180.0), 2.0);
    EXPECT_NEAR(position.mm(kY), length * std::sin(degrees * std::numbers::pi / 180.0), 2.0);
  }
}

TEST(PositionEstimate, BackwardsIsTheOppositeDistance) {
  PositionEstimate position(kCount_um_q4, 0);
  for (int tick = 0; tick < 500; ++tick) position.update(2, 2, 0, 0, 255);
  for (int tick = 0; tick < 500; ++tick) position.update(-2, -2, 0, 0, 255);
  EXPECT_EQ(position.mm(kX), 0);
  EXPECT_EQ(position.mm(kY), 0);
}

TEST(PositionEstimate, ASquareCloses) {
  PositionEstimate position(kCount_um_q4, 0);
  for (int side = 0; side < 4; ++side) {
    for (int tick = 0; tick < 800; ++tick) position.update(2, 2, wrap_angle(side * 16384), 0, 255);
    // Turns on the spot: the tracks run against each other and cover no distance.
    for (int tick = 0; tick < 100; ++tick)
      position.update(-3, 3, wrap_angle(side * 16384 + tick * 163), 0, 255);
  }
  EXPECT_NEAR(position.mm(kX), 0, 1);
  EXPECT_NEAR(position.mm(kY), 0, 1);
}

TEST(PositionEstimate, ACircleHasItsDiameterAndCloses) {
  // Heading of the middle of each tick, so that the polygon closes exactly; 3000 ticks of 5 counts
  // on both tracks.
  constexpr int kTicks = 3000;
  PositionEstimate position(kCount_um_q4, 0);
  int32_t north_most = 0;
  for (int tick = 0; tick < kTicks; ++tick) {
    position.update(2, 3, wrap_angle(static_cast<int32_t>((tick + 0.5) * 65536.0 / kTicks)), 0,
                    255);
    north_most = std::max(north_most, position.mm(kY));
  }
  EXPECT_NEAR(position.mm(kX), 0, 2);
  EXPECT_NEAR(position.mm(kY), 0, 2);
  EXPECT_NEAR(north_most, kTicks * 2.5 * kCount_mm / std::numbers::pi, 2.0);
}

TEST(PositionEstimate, OnASlopeOnlyTheHorizontalPartCounts) {
  for (const int pitch_deg : {-30, 30, 60}) {
    PositionEstimate position(kCount_um_q4, 0);
    for (int tick = 0; tick < 1000; ++tick)
      position.update(2, 2, 0, wrap_angle(pitch_deg * 65536 / 360), 255);
    EXPECT_NEAR(position.mm(kX), 2000 * kCount_mm * std::cos(pitch_deg * std::numbers::pi / 180.0),
                1.0);
  }
}

TEST(PositionEstimate, HalfCountsAreNotLost) {
  // One track alone: half a count of travel a tick.
  PositionEstimate position(kCount_um_q4, 0);
  for (int tick = 0; tick < 10000; ++tick) position.update(tick % 2 == 0 ? 1 : 0, 0, 0, 0, 255);
  EXPECT_NEAR(position.mm(kX), 2500 * kCount_mm, 0.002 * 2500 * kCount_mm);
}

TEST(PositionEstimate, APlaceStopsAtItsRange) {
  PositionEstimate position(kCount_um_q4, 0);
  for (int tick = 0; tick < 1000; ++tick) position.update(-100, 100, 0, 0, 255);
  EXPECT_EQ(position.mm(kX), 0) << "on the spot";
  for (int tick = 0; tick < 1000; ++tick) position.update(-100, -100, 0, 0, 255);
  EXPECT_NEAR(position.mm(kX), -100'000 * kCount_mm, 40.0);
  EXPECT_EQ(place_of(position).mm[kX], -INT16_MAX);
}

// Tracks that turn before a wall move nothing; on the way back all of their travel counts again.
TEST(PositionEstimate, BetweenWallsThePlaceIsTheNearestThatIsPossible) {
  for (const int sign : {1, -1}) {
    PositionEstimate position(kCount_um_q4, 0);
    const int16_t walls[2] = {1000, 0};
    const Angle heading = wrap_angle(8192);  // as far east as north
    const auto drive = [&](int ticks, int counts) {
      const auto both = static_cast<int16_t>(counts);
      for (int tick = 0; tick < ticks; ++tick) {
        position.update(both, both, heading, 0, 255);
        position.keep_inside(walls);
      }
    };
    const double step_mm = 2 * kCount_mm * std::numbers::sqrt2 / 2;
    drive(1000, sign * 2);
    EXPECT_NEAR(position.mm(kX), sign * 1000 * step_mm, 2.0) << "0.8 m: nowhere near";
    drive(2000, sign * 2);
    EXPECT_NEAR(position.mm(kX), sign * 1000, 8.0);
    EXPECT_NEAR(position.mm(kY), sign * 3000 * step_mm, 3.0) << "there is no wall";
    drive(500, sign * -2);
    EXPECT_NEAR(position.mm(kX), sign * (1000 - 500 * step_mm), 9.0);
  }
}

// Half of what the belts travel moves the robot.
TEST(PositionEstimate, SlipIsTakenOff) {
  for (const int share : {0, 63, 127, 255}) {
    PositionEstimate position(kCount_um_q4, 0);
    for (int tick = 0; tick < 1000; ++tick)
      position.update(3, 3, 0, 0, static_cast<uint8_t>(share));
    // 131 / 128 for 1.024, and (share + 1) / 256.
    EXPECT_NEAR(position.mm(kX), 3000 * kCount_mm * (share + 1) / 256.0, 2.0) << share;
  }
}

// The variance that a metre lost by slip makes is that of the parameter, and a 32nd of it a metre
// that is not lost, whatever the robot does on it.
TEST(PositionEstimate, DeviationGrowsWithTheRootOfWhatSlipTakes) {
  const auto sigma_after = [](double distance_m, int16_t left, int16_t right, uint8_t share) {
    PositionEstimate position(kCount_um_q4, 448);
    const double step_mm = (std::abs(left) + std::abs(right)) / 2.0 * kCount_mm;
    const auto ticks = static_cast<int>(distance_m * 1000.0 / step_mm);
    for (int tick = 0; tick < ticks; ++tick) position.update(left, right, 0, 0, share);
    return 4.0 * place_of(position).sigma[kX];
  };
  const double kept_1_m = std::sqrt(448.0 / 32.0 * 125.0);
  EXPECT_NEAR(sigma_after(1.0, 2, 2, 255), kept_1_m, 4.0);
  EXPECT_NEAR(sigma_after(1.0, -2, 2, 255), kept_1_m, 4.0) << "turns on the spot";
  EXPECT_NEAR(sigma_after(25.0, 2, 2, 255), 5.0 * kept_1_m, 8.0);
  EXPECT_NEAR(sigma_after(1.0, 2, 2, 0), std::sqrt(448.0 * 125.0 * 33.0 / 32.0), 9.0);
  EXPECT_NEAR(sigma_after(1.0, -2, -2, 127), std::sqrt(448.0 * 125.0 * 17.0 / 32.0), 6.0);
  EXPECT_EQ(sigma_after(1000.0, 2, 2, 255), 724.0) << "and stops";
}

// Two measurements of the same variance: the mean, and the root of half the variance.
TEST(PositionEstimate, AMeasurementIsWeighedByItsVariance) {
  PositionEstimate position(kCount_um_q4, 100);
  while (place_of(position).sigma[kX] < 50) position.update(2, -2, 0, 0, 255);  // 200 mm
  EXPECT_TRUE(position.measure(kX, 300, 200, 9));
  EXPECT_NEAR(position.mm(kX), 150, 3);
  EXPECT_NEAR(4.0 * place_of(position).sigma[kX], 200.0 / std::sqrt(2.0), 4.0);
  EXPECT_EQ(position.mm(kY), 0);
  EXPECT_EQ(place_of(position).sigma[kY], 50) << "the other axis knows nothing of it";
}

TEST(PositionEstimate, AMeasurementBeyondItsGateIsLeftOut) {
  const auto taken = [](int16_t z_mm, std::uint8_t gate) {
    PositionEstimate position(kCount_um_q4, 100);
    while (place_of(position).sigma[kX] < 25) position.update(2, -2, 0, 0, 255);  // 100 mm
    const bool it_was = position.measure(kX, z_mm, 40, gate);
    EXPECT_EQ(it_was, position.mm(kX) != 0) << z_mm;
    return it_was;
  };
  // 3 root(100^2 + 40^2) = 323
  EXPECT_TRUE(taken(310, 9));
  EXPECT_TRUE(taken(-310, 9));
  EXPECT_FALSE(taken(336, 9));
  EXPECT_FALSE(taken(-32000, 9));
  EXPECT_TRUE(taken(336, 0));
  EXPECT_TRUE(taken(-32000, 0));
}

// The tracks turn and the robot stands, which the slip watch did not notice: fixes hold it.
TEST(PositionEstimate, FixesBoundErrorAndDeviation) {
  PositionEstimate position(kCount_um_q4, 448);
  for (int second = 0; second < 600; ++second) {
    for (int tick = 0; tick < 100; ++tick) position.update(2, 2, 16384, 0, 255);
    position.measure(kY, 1000, 30, 0);
  }
  // Steady: p (1 - k) + q = p, k = p / (p + r), with q = 448 / 32 * 125 mm^2 * 0.113, r = 30^2
  // mm^2: k is 0.37, so what is left of 113 mm a second is 113 (1 - k) / k.
  EXPECT_NEAR(position.mm(kY), 1000 + 193, 12);
  EXPECT_NEAR(4 * place_of(position).sigma[kY], 18, 4);
  EXPECT_GE(4 * place_of(position).sigma[kX], 300) << "nobody measured that";
}

TEST(PositionEstimate, AResetKnowsThePlaceForSure) {
  PositionEstimate position(1000, 1000);
  for (int tick = 0; tick < 4700; ++tick) position.update(1, 1, 8192, 0, 127);
  ASSERT_GT(place_of(position).sigma[kX], 20);
  position.reset();
  const Place place = place_of(position);
  EXPECT_EQ(place.mm[kX], 0);
  EXPECT_EQ(place.mm[kY], 0);
  EXPECT_EQ(place.sigma[kX], 0);
  EXPECT_EQ(place.sigma[kY], 0);
}

// Where a robot is that touches a wall.

constexpr int kDegree = 65536 / 360;

Parameters site() {
  Parameters parameters;
  parameters.site_x() = 1000;
  parameters.site_y() = 700;
  return parameters;
}

/// A robot that believes itself at the origin, +-400 mm.
PositionEstimate uncertain() {
  PositionEstimate position(kCount_um_q4, 1000);
  Place place{};
  while (place.sigma[kX] < 100) {
    position.update(2, -2, 0, 0, 255);
    position.get(place);
  }
  return position;
}

TEST(SiteWalls, TheWallIsTheOneItTravelsToMostDirectly) {
  const int16_t reach = static_cast<int16_t>(kBoard.hull_reach_mm);
  struct Case {
    int degrees;
    Axis axis;
    int wall_mm;
  };
  for (const Case it :
       {Case{0, kX, 1000 - reach}, Case{44, kX, 1000 - reach}, Case{46, kY, 700 - reach},
        Case{134, kY, 700 - reach}, Case{136, kX, reach - 1000}, Case{180, kX, reach - 1000},
        Case{-134, kY, reach - 700}, Case{-46, kY, reach - 700}, Case{-44, kX, 1000 - reach}}) {
    PositionEstimate position = uncertain();
    ASSERT_TRUE(touch_wall(kBoard, site(), wrap_angle(it.degrees * kDegree), true, position))
        << it.degrees;
    // 400 mm against 40: all but a hundredth.
    EXPECT_NEAR(position.mm(it.axis), it.wall_mm, 16) << it.degrees;
    EXPECT_EQ(position.mm(1 - it.axis), 0) << it.degrees;
    Place place;
    position.get(place);
    EXPECT_LE(place.sigma[it.axis], 10) << it.degrees;
  }
}

TEST(SiteWalls, AWallThatCannotBeThereIsNone) {
  PositionEstimate sure(kCount_um_q4, 0);
  EXPECT_FALSE(touch_wall(kBoard, site(), 0, true, sure));
  EXPECT_EQ(sure.mm(kX), 0);
}

// One blow may be false; but where blow follows blow it is the place that is.
TEST(SiteWalls, AWallThatIsTooFarOffIsBelievedInTheEnd) {
  Parameters parameters = site();
  parameters.site_x() = 1500;  // 1355 mm: 3.4 deviations of 402 mm, 2.8 of 477 mm
  PositionEstimate position = uncertain();
  EXPECT_FALSE(touch_wall(kBoard, parameters, 0, true, position));
  EXPECT_EQ(position.mm(kX), 0);
  Place place;
  position.get(place);
  EXPECT_NEAR(4 * place.sigma[kX], 477, 8);
  EXPECT_LT(4 * place.sigma[kY], 420) << "of the other axis it knows what it knew";
  EXPECT_TRUE(touch_wall(kBoard, parameters, 0, true, position));
  EXPECT_NEAR(position.mm(kX), 1500 - kBoard.hull_reach_mm, 20);
}

// Piled ground softens the blow. Who is stuck short of the wall may have dug in.
TEST(SiteWalls, NotFeltItIsThereForARobotThatBelievesToBeBeyond) {
  const int wall = 1000 - kBoard.hull_reach_mm;
  for (const int sign : {1, -1}) {
    const Angle travel = sign > 0 ? 0 : wrap_angle(180 * kDegree);
    for (const int beyond : {-100, 100, 400}) {
      PositionEstimate position = uncertain();
      position.measure(kX, static_cast<int16_t>(sign * (wall + beyond)), 40, 0);
      const int before = position.mm(kX) * sign;
      EXPECT_EQ(touch_wall(kBoard, site(), travel, false, position), beyond == 100);
      const int moved = position.mm(kX) * sign - before;
      EXPECT_NEAR(moved, beyond == 100 ? -50 : 0, 5)
          << sign * beyond << ": halfway, as sure of both";
    }
  }
}

TEST(SiteWalls, DoubtHasAnEnd) {
  Parameters parameters = site();
  parameters.site_x() = 15000;
  PositionEstimate position = uncertain();
  for (int blow = 0; blow < 50; ++blow) {
    EXPECT_FALSE(touch_wall(kBoard, parameters, 0, true, position));
    position.update(0, 0, 0, 0, 255);
  }
  Place place;
  position.get(place);
  EXPECT_NEAR(4 * place.sigma[kX], 724, 4);
}

TEST(SiteWalls, ASiteMayHaveWallsOnTwoSidesOnlyOrNone) {
  Parameters parameters = site();
  parameters.site_y() = 0;
  PositionEstimate position = uncertain();
  EXPECT_FALSE(touch_wall(kBoard, parameters, 90 * kDegree, true, position));
  EXPECT_EQ(position.mm(kY), 0);
  EXPECT_TRUE(touch_wall(kBoard, parameters, 0, true, position));
}

}  // namespace

}  // namespace screed
