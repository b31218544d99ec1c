// Where a robot is that touches a wall.
#include "firmware/estimation/site_walls.h"

#include <gtest/gtest.h>

#include "boards/a_star_32u4/board.h"

namespace screed {
namespace {

constexpr uint16_t kCount_um_q4 = 9048;
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
