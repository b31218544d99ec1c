// Cells of soil by number and by place.
#include "host_sim/physics/soil/soil_grid.h"

#include <gtest/gtest.h>

#include <utility>

namespace screed {
namespace {

TEST(SoilGrid, ACellIsFoundAcrossTheEdgeOfAFieldThatRepeatsAndNotOfOneThatDoesNot) {
  const SoilGrid wrapped(HeightField(5, 5, 0.01, true), 0);
  const auto number = [&](int ix, int iy) {
    GridNode at{0, ix, iy};
    EXPECT_TRUE(wrapped.find(at));
    EXPECT_EQ(at.node, wrapped.node(ix, iy));
    return at.node;
  };
  EXPECT_EQ(number(-1, 0), 4U);
  EXPECT_EQ(number(5, -1), 20U);
  EXPECT_EQ(number(-6, 12), 14U);
  const SoilGrid edged(HeightField(5, 5, 0.01, false), 0);
  GridNode corner{0, 4, 4};
  EXPECT_TRUE(edged.find(corner));
  EXPECT_EQ(corner.node, 24U);
  for (const auto& [ix, iy] : {std::pair{-1, 0}, {5, 0}, {0, -1}, {0, 5}}) {
    GridNode outside{0, ix, iy};
    EXPECT_FALSE(edged.find(outside)) << ix << " " << iy;
  }
}

TEST(SoilGrid, AHeightIsSetThroughAPlaceThatTheFieldRepeats) {
  SoilGrid grid(HeightField(5, 4, 0.01, true), 0);
  grid.set_height(grid.place(-1, 6), 30);
  EXPECT_EQ(grid.surface().node(4, 2), 30);
  grid[14].sunk = 12;
  EXPECT_EQ(grid.reference(14), 42);
}

}  // namespace
}  // namespace screed
