// How much of a driven path a run's pictures show.
#include "host_sim/run/simulation/run_pictures.h"

#include <gtest/gtest.h>

namespace screed {
namespace {

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
