// Pictures of a run.
#include <gtest/gtest.h>
#include <cstddef>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/run/simulation/run_pictures.h"

namespace screed {

namespace {

// What the picture of a leveling run says: figures, maps, curves.

LevelingPoint point_at(double time_s, double relief_m, double roughness_m) {
  LevelingPoint point;
  point.time = time_s;
  point.level_deviation = 1.5 * relief_m;
  point.relief = relief_m;
  point.roughness = roughness_m;
  return point;
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t found = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1))
    ++found;
  return found;
}

class LevelingPicture : public ::testing::Test {
 protected:
  std::string svg() const { return leveling_svg("bed: 60 s", before_, after_, points_); }

  HeightField before_ = HeightField::ramp(1.0, 0.05, 8.0);
  HeightField after_ = HeightField::ramp(1.0, 0.05, 2.0);
  std::vector<LevelingPoint> points_ = {point_at(0.0, 0.012, 0.002), point_at(30.0, 0.008, 0.003),
                                        point_at(60.0, 0.0054, 0.0025)};
};

TEST_F(LevelingPicture, SaysByHowMuchFromTheFirstPointToTheLast) {
  const std::string text = svg();
  EXPECT_NE(text.find("bed: 60 s"), std::string::npos);
  EXPECT_NE(text.find("height about level 18.0 \u2192 8.1 mm (\u221255 %)"), std::string::npos);
  EXPECT_NE(text.find("12.0 \u2192 5.4 mm (\u221255 %)"), std::string::npos);
  EXPECT_NE(text.find("2.0 \u2192 2.5 mm (+25 %)"), std::string::npos);
  EXPECT_EQ(count(text, "<image"), 2U) << "before and after";
}

TEST_F(LevelingPicture, DrawsTheWorkThatRemainsWhereItWasMeasured) {
  EXPECT_EQ(svg().find("work remaining [%]"), std::string::npos);
  points_.front().progress = 0.0;
  points_.back().progress = 0.25;
  EXPECT_NE(svg().find("work remaining [%]"), std::string::npos);
}

TEST_F(LevelingPicture, HasItsUnitsInBrackets) {
  EXPECT_EQ(count(svg(), ">height [mm]<"), 2U) << "of both maps";
  for (const char* other : {"(mm)", "(m)", ", mm<", ", m<"})
    EXPECT_EQ(count(svg(), other), 0U) << other;
}

TEST_F(LevelingPicture, OfLevelGroundSaysNoPerCent) {
  points_.front().relief = 0.0;
  EXPECT_NE(svg().find("0.0 \u2192 5.4 mm,"), std::string::npos) << "neither inf nor nan";
}

TEST_F(LevelingPicture, NeedsACurve) {
  points_.resize(1);
  EXPECT_THROW(svg(), InputError);
}

// How much of a driven path a run's pictures show.

TEST(RunPictures, TheEndOfALongPathAndAllOfAShortOne) {
  std::vector<PathPoint> path;
  path.reserve(11);
  for (int i = 0; i < 11; ++i) path.push_back({0.1 * i, 0.0, 1});  // a metre
  EXPECT_EQ(last_stretch(path, 2.0, 3.0).size(), 11U);
  const std::span<const PathPoint> end = last_stretch(path, 0.35, 3.0);
  ASSERT_EQ(end.size(), 4U);
  EXPECT_DOUBLE_EQ(end.front().x_m, 0.7);
  EXPECT_DOUBLE_EQ(end.back().x_m, 1.0);
  EXPECT_EQ(last_stretch(path, 0.0, 3.0).size(), 1U) << "where it ended";
  EXPECT_TRUE(last_stretch({}, 1.0, 3.0).empty());
  // Over the edge of a wrapped bed, 0.4 m wide, nothing is driven.
  path = {{0.15, 0.0, 1}, {-0.15, 0.0, 1}, {-0.05, 0.0, 1}};
  EXPECT_EQ(last_stretch(path, 0.15, 0.4).size(), 3U);
  EXPECT_EQ(last_stretch(path, 0.15, 3.0).size(), 2U);
  // Who stands has driven nothing.
  path.assign(5, {0.3, 0.4, 1});
  EXPECT_EQ(last_stretch(path, 0.1, 3.0).size(), 5U);
}

}  // namespace

}  // namespace screed
