// Volumes of moved boxes.
#include "host_sim/physics/terrain/terrain_change.h"

#include <gtest/gtest.h>

#include <cmath>

#include "host_sim/core/errors.h"

namespace screed {
namespace {

constexpr double kSpacing_m = 0.01;

/// Raises nodes x..x+9, y..y+4 by `by_m`: 0.005 m2.
void raise_box(HeightField& field, int x, int y, double by_m) {
  for (int iy = y; iy < y + 5; ++iy) {
    for (int ix = x; ix < x + 10; ++ix)
      field.set_node(ix, iy,
                     field.node(ix, iy) + static_cast<Height>(std::lround(by_m / kHeightUnit_m)));
  }
}

TEST(TerrainChange, ABoxMovedAside) {
  HeightField before(80, 60, kSpacing_m, false);
  raise_box(before, 10, 10, 0.03);
  HeightField after(80, 60, kSpacing_m, false);
  raise_box(after, 40, 30, 0.03);
  const TerrainChange change = terrain_change(before, after);
  EXPECT_NEAR(change.cut_m3, 0.005 * 0.03, 1e-9);
  EXPECT_NEAR(change.fill_m3, 0.005 * 0.03, 1e-9);
  EXPECT_NEAR(change.moved_m3(), 0.005 * 0.03, 1e-9);
  EXPECT_NEAR(change.deepest_cut_m, 0.03, kHeightUnit_m);
  EXPECT_NEAR(change.deepest_fill_m, 0.03, kHeightUnit_m);
}

TEST(TerrainChange, WhatIsPressedDownIsCutAndNotMoved) {
  const HeightField before(80, 60, kSpacing_m, true);
  HeightField after = before;
  raise_box(after, 20, 20, -0.02);
  TerrainChange change = terrain_change(before, after);
  EXPECT_NEAR(change.cut_m3, 0.005 * 0.02, 1e-9);
  EXPECT_EQ(change.fill_m3, 0.0);
  EXPECT_EQ(change.moved_m3(), 0.0);
  EXPECT_NEAR(change.deepest_cut_m, 0.02, kHeightUnit_m);
  EXPECT_EQ(change.deepest_fill_m, 0.0);

  raise_box(after, 50, 20, 0.005);  // a quarter of it stands elsewhere
  change = terrain_change(before, after);
  EXPECT_NEAR(change.moved_m3(), 0.005 * 0.005, 1e-9);
  EXPECT_NEAR(change.deepest_fill_m, 0.005, kHeightUnit_m);
}

TEST(TerrainChange, NothingChangedIsZero) {
  const HeightField ramp = HeightField::ramp(1.0, 0.02, 10.0);
  const TerrainChange change = terrain_change(ramp, ramp);
  EXPECT_EQ(change.cut_m3, 0.0);
  EXPECT_EQ(change.fill_m3, 0.0);
  EXPECT_EQ(change.deepest_cut_m, 0.0);
  EXPECT_EQ(change.deepest_fill_m, 0.0);
}

TEST(TerrainChange, NeedsTheSameGrid) {
  const HeightField grid(20, 20, 0.1, false);
  for (const HeightField& other :
       {HeightField(21, 20, 0.1, false), HeightField(20, 21, 0.1, false),
        HeightField(20, 20, 0.2, false), HeightField(20, 20, 0.1, true)}) {
    EXPECT_THROW(terrain_change(grid, other), InputError);
  }
}

}  // namespace
}  // namespace screed
