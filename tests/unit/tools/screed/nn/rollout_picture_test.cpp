// How far a predicted robot is from the recorded one, and the picture of it.
#include "tools/screed/nn/rollout_picture.h"

#include <gtest/gtest.h>

#include <numbers>
#include <string>
#include <vector>

#include "host_sim/core/errors.h"

namespace screed {
namespace {

using Path = std::vector<PlanarPose>;

TEST(RolloutPicture, DeviationIsOverTheDistanceOfThePhysics) {
  const Path physics = {{0.0, 0.0, 0.0}, {3.0, 4.0, 0.1}, {3.0, 6.0, 3.0}};
  const Path predicted = {{0.0, 0.0, 0.0}, {3.0, 4.5, 0.0}, {6.0, 6.0, -3.0}, {9.0, 9.0, 0.0}};
  const auto deviation = rollout_deviation(physics, predicted);
  ASSERT_EQ(deviation.size(), 3U);
  EXPECT_EQ(deviation[0].distance_m, 0.0);
  EXPECT_EQ(deviation[0].position_m, 0.0);
  EXPECT_DOUBLE_EQ(deviation[1].distance_m, 5.0);
  EXPECT_DOUBLE_EQ(deviation[1].position_m, 0.5);
  EXPECT_NEAR(deviation[1].heading_deg, -0.1 * 180.0 / std::numbers::pi, 1e-9);
  EXPECT_DOUBLE_EQ(deviation[2].distance_m, 7.0);
  EXPECT_DOUBLE_EQ(deviation[2].position_m, 3.0);
  // From 3 to -3 rad it is shorter on the other side.
  EXPECT_NEAR(deviation[2].heading_deg, (2.0 * std::numbers::pi - 6.0) * 180.0 / std::numbers::pi,
              1e-9);
}

TEST(RolloutPicture, ShowsPathsAndBothDeviationsOfEachPrediction) {
  RolloutPicture picture;
  picture.title = "session";
  picture.physics = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {2.0, 0.0, 0.0}};
  picture.predictions = {{"no slip", {{0.0, 0.0, 0.0}, {1.1, 0.0, 0.0}, {2.2, 0.1, 0.1}}},
                         {"network", {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {2.0, 0.0, 0.0}}}};
  const std::string svg = rollout_svg(picture);
  const auto count = [&svg](const std::string& what) {
    int found = 0;
    for (size_t at = svg.find(what); at != std::string::npos; at = svg.find(what, at + 1)) ++found;
    return found;
  };
  EXPECT_EQ(count("<polyline"), 3 + 2 + 2) << "paths, position, heading";
  EXPECT_EQ(count(">no slip<"), 3) << "in the legend of map and both panels";
  EXPECT_EQ(count(">physics<"), 1);
  EXPECT_EQ(count(">position deviation [mm]<"), 1);
  EXPECT_EQ(count(">heading deviation [deg]<"), 1);
  EXPECT_EQ(count(">distance driven by the physics [m]<"), 1);
  EXPECT_THROW(rollout_svg({}), InputError);
}

}  // namespace
}  // namespace screed
