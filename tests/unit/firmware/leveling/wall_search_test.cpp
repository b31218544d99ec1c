// What a lost robot does.
#include "firmware/leveling/wall_search.h"

#include <gtest/gtest.h>

#include "firmware/leveling/leveling.h"

namespace screed {
namespace {

Parameters lost_beyond_200_mm(LostAction action) {
  Parameters parameters;
  parameters.lost_sigma() = 200;
  parameters.lost_action() = static_cast<int16_t>(action);
  parameters.site_x() = 1500;
  parameters.site_y() = 1500;
  return parameters;
}

Place place(int16_t x_mm, int16_t y_mm, int sigma_x_mm, int sigma_y_mm) {
  return {{x_mm, y_mm},
          {static_cast<uint8_t>(sigma_x_mm / 4), static_cast<uint8_t>(sigma_y_mm / 4)}};
}

TEST(WallSearch, DrivesToTheNearerWallOfTheAxisItKnowsLeast) {
  WallSearch search(lost_beyond_200_mm(LostAction::kSeekWall));
  EXPECT_FALSE(search.update(place(100, 100, 200, 200)));
  EXPECT_TRUE(search.update(place(100, -100, 204, 100)));
  EXPECT_GT(search.east(), 0);
  EXPECT_EQ(search.north(), 0);
  EXPECT_TRUE(search.update(place(100, -100, 40, 204))) << "found one, and looks for the other";
  EXPECT_EQ(search.east(), 0);
  EXPECT_LT(search.north(), 0);
  EXPECT_TRUE(search.update(place(-100, -100, 104, 104))) << "until half of it";
  EXPECT_LT(search.east(), 0);
  EXPECT_FALSE(search.update(place(100, -100, 100, 100)));
  EXPECT_FALSE(search.gave_up());
}

TEST(WallSearch, WithoutAWallThereItStops) {
  Parameters parameters = lost_beyond_200_mm(LostAction::kSeekWall);
  parameters.site_y() = 0;
  WallSearch search(parameters);
  EXPECT_TRUE(search.update(place(0, 0, 300, 100)));
  EXPECT_FALSE(search.gave_up());
  EXPECT_FALSE(search.update(place(0, 0, 100, 300)));
  EXPECT_TRUE(search.gave_up());
}

TEST(WallSearch, StopsUntilItKnowsAgain) {
  WallSearch stops(lost_beyond_200_mm(LostAction::kStop));
  EXPECT_FALSE(stops.update(place(0, 0, 204, 0)));
  EXPECT_TRUE(stops.gave_up());
  EXPECT_FALSE(stops.update(place(0, 0, 40, 0)));
  EXPECT_FALSE(stops.gave_up()) << "a fix has told where it is";
}

TEST(WallSearch, WithoutALimitItIsNeverLost) {
  Parameters parameters = lost_beyond_200_mm(LostAction::kStop);
  parameters.lost_sigma() = 0;
  WallSearch search(parameters);
  EXPECT_FALSE(search.update(place(0, 0, 1020, 1020)));
  EXPECT_FALSE(search.gave_up());
}

// As a motion: towards the wall, in a state of its own, and no peak of a climb that it cut off.
TEST(WallSearch, LevelingSeeksTheWall) {
  Parameters parameters = lost_beyond_200_mm(LostAction::kSeekWall);
  parameters.algorithm() = static_cast<int16_t>(LevelingAlgorithm::kHillSensing);
  Leveling leveling(parameters);
  leveling.start();
  LevelingInput input{};
  input.pitch = 2000;
  leveling.tick(input);
  ASSERT_EQ(leveling.state(), LevelingState::kClimb);
  input.place = place(100, 0, 300, 0);
  const MotionCommand motion = leveling.tick(input);
  EXPECT_EQ(leveling.state(), LevelingState::kSeekWall);
  EXPECT_EQ(motion.speed_mm_per_s, parameters.walk_speed_max());
  EXPECT_EQ(motion.yaw_rate, 0) << "east already";
  EXPECT_EQ(leveling.peaks(), 0);
  EXPECT_FALSE(leveling.lost());
}

}  // namespace
}  // namespace screed
