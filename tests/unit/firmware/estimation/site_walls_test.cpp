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
  parameters.site_x = 1000;
  parameters.site_y = 700;
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
    ASSERT_TRUE(touch_wall(kBoard, site(), wrap_angle(it.degrees * kDegree), false, position))
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
  EXPECT_FALSE(touch_wall(kBoard, site(), 0, false, sure));
  EXPECT_EQ(sure.mm(kX), 0);
}

TEST(SiteWalls, AWallThatWasSoughtMayBeFartherOff) {
  Parameters parameters = site();
  parameters.site_x = 1800;  // 1655 mm: 4.1 deviations of 402 mm
  PositionEstimate position = uncertain();
  EXPECT_FALSE(touch_wall(kBoard, parameters, 0, false, position));
  EXPECT_TRUE(touch_wall(kBoard, parameters, 0, true, position));
  EXPECT_NEAR(position.mm(kX), 1800 - kBoard.hull_reach_mm, 20);
  parameters.site_x = 2200;  // 5.1
  PositionEstimate again = uncertain();
  EXPECT_FALSE(touch_wall(kBoard, parameters, 0, true, again));
}

TEST(SiteWalls, ASiteMayHaveWallsOnTwoSidesOnlyOrNone) {
  Parameters parameters = site();
  parameters.site_y = 0;
  PositionEstimate position = uncertain();
  EXPECT_FALSE(touch_wall(kBoard, parameters, 90 * kDegree, false, position));
  EXPECT_EQ(position.mm(kY), 0);
  EXPECT_TRUE(touch_wall(kBoard, parameters, 0, false, position));
}

}  // namespace
}  // namespace screed
