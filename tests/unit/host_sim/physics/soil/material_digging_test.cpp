// What a slipping footprint digs: where from, how much, and where it goes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/unit/host_sim/physics/soil/level_material.h"

namespace screed {
namespace {

DugPatch patch_at(double x, double y) {
  return {{x, y}, {1.0, 0.0}, 2.0 * kSpacing_m, 1.0 * kSpacing_m, 3.0 * kSpacing_m};
}

/// A quarter of what is moved gets denser instead, without an end.
constexpr Compaction kQuarter{0.25, 0.0};

TEST(MaterialDigging, DigsWhereTheFootprintSlipsInProportionToIt) {
  MaterialFlow flow = level(21, false, kQuarter);
  flow.begin_footprint();
  flow.shear(flow.grid().node(10, 10), 1.0);
  flow.shear(flow.grid().node(11, 10), 3.0);
  flow.dig(patch_at(0.0, 0.0), 400);
  EXPECT_EQ(flow.compacted(), 100);
  EXPECT_EQ(height(flow, 10, 10), -100);
  EXPECT_EQ(height(flow, 11, 10), -300);
  EXPECT_EQ(flow.grid().reference(flow.grid().node(11, 10)), -300) << "a hole, and no sinkage";
  EXPECT_EQ(flow.in_transit(), 300);
  flow.dig(patch_at(0.0, 0.0), 400);
  EXPECT_EQ(flow.in_transit(), 300) << "where it slipped is forgotten";
  EXPECT_EQ(flow.compacted(), 100);
}

TEST(MaterialDigging, DigsToTheLastUnitWhereItDoesNotDivide) {
  MaterialFlow flow = level();
  flow.begin_footprint();
  for (int i = 0; i < 7; ++i) flow.shear(flow.grid().node(7 + i, 10), 1.0);
  flow.dig(patch_at(0.0, 0.0), 100);
  EXPECT_EQ(volume(flow), -100);
  for (int i = 0; i < 7; ++i) EXPECT_NEAR(height(flow, 7 + i, 10), -14, 1) << i;
}

TEST(MaterialDigging, DigsToTheLastUnitWhateverTheWeightsAddUpTo) {
  for (int count = 1; count < 60; ++count) {
    for (const int units : {1, 2, 999, 1000, 12345}) {
      MaterialFlow flow = level();
      flow.begin_footprint();
      for (int i = 0; i < count; ++i) {
        flow.shear(static_cast<size_t>(i), 0.1 * (1 + i % 7) / 3.0);
      }
      flow.dig(patch_at(0.0, 0.0), units);
      ASSERT_EQ(volume(flow), -units) << count;
    }
  }
}

TEST(MaterialDigging, OnlyWhatGivesOrGetsMaterialIsLookedAtAgain) {
  MaterialFlow flow = level();
  flow.begin_footprint();
  for (int i = 0; i < 4; ++i) flow.shear(flow.grid().node(8 + i, 10), 1.0);
  flow.dig(patch_at(0.0, 0.0), 1);
  EXPECT_EQ(flow.queued(), 1U) << "one unit comes from one node";
  flow.deposit();
  EXPECT_EQ(flow.queued(), 2U) << "and goes to one";
}

TEST(MaterialDigging, WhatIsCompactedWhileDiggingIsNotHeapedUp) {
  MaterialFlow flow = level(21, false, kQuarter);
  flow.begin_footprint();
  flow.shear(flow.grid().node(10, 10), 1.0);
  flow.dig(patch_at(0.0, 0.0), 400);
  flow.deposit();
  EXPECT_EQ(flow.in_transit(), 0);
  EXPECT_EQ(volume(flow), -100);
}

TEST(MaterialDigging, APlaceGetsNoDenserThanItCan) {
  MaterialFlow flow = level(21, false, {0.25, 150.0 * kHeightUnit_m});
  const size_t here = flow.grid().node(10, 10);
  const auto dig = [&](int64_t units) {
    flow.begin_footprint();
    flow.shear(here, 1.0);
    flow.dig(patch_at(0.0, 0.0), units);
    flow.uncover();
  };
  dig(400);
  EXPECT_EQ(flow.compacted(), 100) << "its share";
  dig(400);
  EXPECT_EQ(flow.compacted(), 150) << "all that it may lose";
  dig(400);
  EXPECT_EQ(flow.compacted(), 150);
  EXPECT_EQ(flow.in_transit(), 1200 - 150) << "the rest moves";
  flow.begin_footprint();
  flow.sink(flow.grid().place(here), 400);
  EXPECT_EQ(flow.compacted(), 150) << "pressing makes it no denser either";
  flow.sink(flow.grid().place(3, 3), 400);
  EXPECT_EQ(flow.compacted(), 250) << "other ground is as loose as before";
}

TEST(MaterialDigging, PartsOfAUnitAreCompactedLater) {
  MaterialFlow flow = level(21, false, kQuarter);
  flow.begin_footprint();
  for (int i = 0; i < 400; ++i) flow.sink(flow.grid().place(10, 10), 1);
  EXPECT_EQ(flow.compacted(), 100);
  EXPECT_EQ(flow.in_transit(), 300);
}

TEST(MaterialDigging, WhatIsDugWithoutABandIsSetDownRoundTheFootprint) {
  MaterialFlow flow = level();
  DugPatch patch = patch_at(0.0, 0.0);
  patch.band = 0.0;
  press(flow, 10, 10, 80);
  flow.shear(flow.grid().node(10, 10), 1.0);
  flow.dig(patch, 720);
  flow.deposit();
  EXPECT_EQ(flow.in_transit(), 0);
  EXPECT_EQ(volume(flow), 0);
  for (const int ix : {9, 11}) EXPECT_EQ(height(flow, ix, 10), 100);
  // Without a footprint to set it down at, it waits.
  flow.uncover();
  flow.shear(flow.grid().node(10, 10), 1.0);
  flow.dig(patch, 8);
  flow.deposit();
  EXPECT_EQ(flow.in_transit(), 8);
  flow.uncover();
  press(flow, 3, 3, 8);
  flow.deposit();
  EXPECT_EQ(flow.in_transit(), 0);
  EXPECT_EQ(height(flow, 4, 4), 2);
}

TEST(MaterialDigging, WhatIsDugIsNotHeapedUpUnderABodyNorBesideTheField) {
  // The patch lies on the field's corner, a quarter of its band on the field.
  MaterialFlow flow = level();
  const DugPatch patch = patch_at(flow.grid().surface().x_min(), flow.grid().surface().y_min());
  for (int step = 0; step < 50; ++step) {
    flow.begin_footprint();
    for (int iy = 0; iy < 3; ++iy) flow.cover(flow.grid().place(4, iy));
    flow.shear(flow.grid().node(10, 10), 1.0);
    flow.dig(patch, 480);
    flow.deposit();
    flow.uncover();
  }
  EXPECT_EQ(flow.in_transit(), 0);
  EXPECT_EQ(volume(flow), 0);
  for (int iy = 0; iy < 3; ++iy) {
    EXPECT_EQ(height(flow, 4, iy), 0) << "a body stands there";
    EXPECT_GT(height(flow, 3, iy), 0);
  }
  EXPECT_EQ(height(flow, 20, 0), 0) << "what lies beyond the edge does not wrap round";
  EXPECT_EQ(height(flow, 0, 20), 0);
}

TEST(MaterialDigging, TheFirstNodeIsHeapedUponAsAnyOther) {
  MaterialFlow flow = level();
  DugPatch patch = patch_at(flow.grid().surface().x_min(), flow.grid().surface().y_min());
  patch.half_length = 0.0;
  patch.half_width = 0.0;
  flow.shear(flow.grid().node(10, 10), 1.0);
  flow.dig(patch, 4800);
  flow.deposit();
  EXPECT_GT(height(flow, 0, 0), 0);
}

TEST(MaterialDigging, WhatIsDugInAStepGoesToFortyEightPlacesFarApart) {
  MaterialFlow flow(HeightField(401, 401, 0.001, false), kRepose_deg);
  const DugPatch patch = {{0.0, 0.0}, {1.0, 0.0}, 0.0, 0.0, 0.15};
  for (const int units : {1, 7, 3}) {
    std::vector<Eigen::Vector2d> places;
    flow.shear(0, 1.0);
    const MaterialFlow before = flow;
    flow.dig(patch, 48 * units);
    flow.deposit();
    for (int iy = 0; iy < 401; ++iy) {
      for (int ix = 0; ix < 401; ++ix) {
        const size_t node = flow.grid().node(ix, iy);
        if (node == 0 || flow.grid().height(node) == before.grid().height(node)) continue;
        EXPECT_EQ(flow.grid().height(node) - before.grid().height(node), units);
        places.emplace_back(flow.grid().surface().node_x(ix), flow.grid().surface().node_y(iy));
      }
    }
    ASSERT_EQ(places.size(), 48U);
    double nearest_m = 1.0;
    for (size_t i = 0; i < places.size(); ++i) {
      for (size_t j = 0; j < i; ++j) {
        nearest_m = std::min(nearest_m, (places[i] - places[j]).norm());
      }
    }
    // A square grid of 48 places would lie 0.3 m / sqrt(48) = 43 mm apart.
    EXPECT_GT(nearest_m, 0.5 * 0.3 / std::sqrt(48.0)) << "evenly spread, not at random";
  }
}

TEST(MaterialDigging, WhatIsCarriedPastTheFootprintKeepsItsAmountTimesWay) {
  MaterialFlow flow = level(61);
  DugPatch patch = patch_at(0.02, -0.03);
  patch.forward = {0.6, 0.8};
  patch.carried = {20.0, -50.0};
  constexpr int kSteps = 400;
  for (int step = 0; step < kSteps; ++step) {
    flow.begin_footprint();
    for (const int ix : {31, 32, 33}) flow.shear(flow.grid().node(ix, 27), 1.0);
    flow.dig(patch, 480);
    flow.deposit();
    ASSERT_EQ(flow.in_transit(), 0);
    ASSERT_EQ(volume(flow), 0);
    flow.uncover();
  }
  Eigen::Vector2d carried = Eigen::Vector2d::Zero();
  for (int iy = 0; iy < 61; ++iy) {
    for (int ix = 0; ix < 61; ++ix) {
      const Eigen::Vector2d at(flow.grid().surface().node_x(ix), flow.grid().surface().node_y(iy));
      carried += height(flow, ix, iy) * (at - patch.centre);
    }
  }
  // The places are those of a grid: its spacing is what the sum is uncertain by.
  EXPECT_NEAR(carried.x() / kSteps, patch.carried.x(), 0.05 * patch.carried.norm());
  EXPECT_NEAR(carried.y() / kSteps, patch.carried.y(), 0.05 * patch.carried.norm());
}

TEST(MaterialDigging, WithoutSlipOrWithNothingToTakeNothingIsDug) {
  MaterialFlow flow = level();
  flow.begin_footprint();
  flow.shear(flow.grid().node(10, 10), 0.0);
  flow.dig(patch_at(0.0, 0.0), 400);
  flow.shear(flow.grid().node(10, 10), 1.0);
  flow.dig(patch_at(0.0, 0.0), 0);
  EXPECT_EQ(volume(flow), 0);
  EXPECT_EQ(flow.in_transit(), 0);
  // What was sheared then is forgotten.
  flow.shear(flow.grid().node(3, 3), 1.0);
  flow.dig(patch_at(0.0, 0.0), 10);
  EXPECT_EQ(height(flow, 10, 10), 0);
  EXPECT_EQ(height(flow, 3, 3), -10);
}

// As on a bed that moves no material: nothing is deposited, steps end all the same.
TEST(MaterialDigging, WhatIsDugAndCompactedLeavesNothingToLaterSteps) {
  MaterialFlow flow = level(41, false, {1.0, 480.0 * kHeightUnit_m});
  MaterialFlow fresh = level(41);
  const size_t dug = flow.grid().node(20, 20);
  flow.begin_footprint();
  flow.shear(dug, 1.0);
  flow.dig(patch_at(0.02, -0.03), 480);
  EXPECT_EQ(flow.compacted(), 480);
  flow.uncover();
  for (MaterialFlow* either : {&flow, &fresh}) {
    either->begin_footprint();
    either->shear(dug, 1.0);
    either->dig(patch_at(0.02, -0.03), 480);
    either->deposit();
    either->uncover();
  }
  for (size_t node = 0; node < flow.grid().size(); ++node) {
    EXPECT_EQ(flow.grid().height(node), fresh.grid().height(node) - (node == dug ? 480 : 0))
        << node;
  }
}

TEST(MaterialDigging, WhatIsDugIsHeapedUpInABandRoundTheFootprintAndNotInsideIt) {
  MaterialFlow flow = level(41);
  DugPatch patch = patch_at(0.02, -0.03);
  patch.forward = {0.6, 0.8};
  const Eigen::Vector2d side(-0.8, 0.6);
  for (int step = 0; step < 400; ++step) {
    flow.begin_footprint();
    flow.shear(flow.grid().node(20, 20), 1.0);
    flow.dig(patch, 480);
    flow.deposit();
    ASSERT_EQ(flow.in_transit(), 0);
    flow.uncover();
  }
  ASSERT_EQ(volume(flow), 0);
  // Fills the hole.
  flow.begin_footprint();
  flow.sink(flow.grid().place(20, 20), -480 * 400);
  double along_sum = 0.0;
  double across_sum = 0.0;
  Height least = INT32_MAX;
  Height most = 0;
  for (int iy = 0; iy < 41; ++iy) {
    for (int ix = 0; ix < 41; ++ix) {
      const Eigen::Vector2d at(flow.grid().surface().node_x(ix), flow.grid().surface().node_y(iy));
      const Eigen::Vector2d from = at - patch.centre;
      const double along = std::abs(from.dot(patch.forward));
      const double across = std::abs(from.dot(side));
      const Height heaped = height(flow, ix, iy);
      along_sum += heaped * from.dot(patch.forward);
      across_sum += heaped * from.dot(side);
      const double rounding = 0.75 * kSpacing_m;  // a place's nearest node is half a diagonal away
      if (along > patch.half_length + patch.band + rounding ||
          across > patch.half_width + patch.band + rounding) {
        EXPECT_EQ(heaped, 0) << "beyond the band: " << at.transpose();
      } else if (along < patch.half_length - rounding && across < patch.half_width - rounding) {
        EXPECT_EQ(heaped, 0) << "below the footprint: " << at.transpose();
      } else if ((along > patch.half_length + rounding || across > patch.half_width + rounding) &&
                 along < patch.half_length + patch.band - rounding &&
                 across < patch.half_width + patch.band - rounding) {
        least = std::min(least, heaped);
        most = std::max(most, heaped);
      }
    }
  }
  EXPECT_GT(least, 0);
  EXPECT_LT(most, 1.3 * least) << "everywhere in the band the same";
  EXPECT_NEAR(along_sum / (480.0 * 400.0), 0.0, 0.1 * kSpacing_m) << "as much before as behind";
  EXPECT_NEAR(across_sum / (480.0 * 400.0), 0.0, 0.1 * kSpacing_m);
}

}  // namespace
}  // namespace screed
