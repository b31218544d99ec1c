// What the picture of a leveling run says: figures, maps, curves.
#include "host_sim/run/simulation/run_pictures.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "host_sim/core/errors.h"

namespace screed {
namespace {

LevelingPoint point_at(double time_s, double relief_m, double roughness_m) {
  LevelingPoint point;
  point.time = time_s;
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
  EXPECT_NE(text.find("12.0 \u2192 5.4 mm (\u221255 %)"), std::string::npos);
  EXPECT_NE(text.find("2.0 \u2192 2.5 mm (+25 %)"), std::string::npos);
  EXPECT_EQ(count(text, "<image"), 2U) << "before and after";
}

TEST_F(LevelingPicture, DrawsTransportWhereItWasMeasured) {
  EXPECT_EQ(svg().find("transport left"), std::string::npos);
  points_.front().progress = 0.0;
  points_.back().progress = 0.25;
  EXPECT_NE(svg().find("transport left"), std::string::npos);
}

TEST_F(LevelingPicture, OfLevelGroundSaysNoPerCent) {
  points_.front().relief = 0.0;
  EXPECT_NE(svg().find("0.0 \u2192 5.4 mm,"), std::string::npos) << "neither inf nor nan";
}

TEST_F(LevelingPicture, NeedsACurve) {
  points_.resize(1);
  EXPECT_THROW(svg(), InputError);
}

}  // namespace
}  // namespace screed
