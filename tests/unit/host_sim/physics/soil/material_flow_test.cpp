// Material on its way: what is in hand, how it is shared out round footprints, what slides.
#include "host_sim/physics/soil/material_flow.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace screed {
namespace {

constexpr double kSpacing_m = 0.01;
constexpr double kRepose_deg = 30.0;

MaterialFlow level(int nodes = 21, bool wrap = false) {
  return {HeightField(nodes, nodes, kSpacing_m, wrap), kRepose_deg};
}

int64_t volume(const MaterialFlow& flow) {
  int64_t sum = 0;
  for (size_t node = 0; node < flow.nodes(); ++node) sum += flow.height(node);
  return sum;
}

/// A footprint of one node, pressed down by so many units.
void press(MaterialFlow& flow, int ix, int iy, Height units, double velocity_x = 0.0,
           double velocity_y = 0.0) {
  const size_t footprint = flow.begin_footprint(velocity_x, velocity_y);
  const size_t node = flow.index(ix, iy);
  flow.cover(node, ix, iy);
  flow.sink(footprint, node, ix, iy, units);
}

TEST(MaterialFlow, WhatSinksIsInHandUntilItIsSetDownRoundTheFootprint) {
  MaterialFlow flow = level();
  press(flow, 10, 10, 800);
  EXPECT_EQ(flow.in_transit(), 800);
  EXPECT_EQ(volume(flow), -800);
  flow.deposit();
  EXPECT_EQ(flow.in_transit(), 0);
  EXPECT_EQ(volume(flow), 0);
  EXPECT_EQ(flow.height(flow.index(10, 10)), -800);
  EXPECT_EQ(flow.reference(flow.index(10, 10)), 0) << "sinkage counts from where the ground was";
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (dx == 0 && dy == 0) continue;
      EXPECT_EQ(flow.height(flow.index(10 + dx, 10 + dy)), 100) << dx << " " << dy;
      EXPECT_EQ(flow.reference(flow.index(10 + dx, 10 + dy)), 100);
    }
  }
}

TEST(MaterialFlow, WhatDoesNotDivideGoesToOtherNeighboursEachTime) {
  MaterialFlow flow = level();
  for (int step = 0; step < 8; ++step) {
    press(flow, 10, 10, 9);
    flow.deposit();
    ASSERT_EQ(flow.in_transit(), 0);
    ASSERT_EQ(volume(flow), 0);
    flow.uncover();
  }
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (dx == 0 && dy == 0) continue;
      EXPECT_EQ(flow.height(flow.index(10 + dx, 10 + dy)), 9) << dx << " " << dy;
    }
  }
}

TEST(MaterialFlow, NothingIsSetDownInTheRutBehindAMovingFootprint) {
  for (const double speed : {0.01, 2.0}) {
    MaterialFlow flow = level();
    press(flow, 10, 10, 500, speed, 0.0);
    flow.deposit();
    for (int dy = -1; dy <= 1; ++dy) {
      EXPECT_EQ(flow.height(flow.index(9, 10 + dy)), 0) << speed;
      EXPECT_EQ(flow.height(flow.index(11, 10 + dy)), 100) << speed;
    }
    EXPECT_EQ(flow.height(flow.index(10, 9)), 100);
    EXPECT_EQ(flow.height(flow.index(10, 11)), 100);
  }
  // Across, and against the axes.
  MaterialFlow flow = level();
  press(flow, 10, 10, 500, 0.0, -0.3);
  flow.deposit();
  EXPECT_EQ(flow.height(flow.index(10, 11)), 0);
  EXPECT_EQ(flow.height(flow.index(10, 9)), 100);
}

TEST(MaterialFlow, AFootprintThatHardlyMovesHasNoRutBehindIt) {
  MaterialFlow flow = level();
  press(flow, 10, 10, 800, 0.0009, 0.0);
  flow.deposit();
  EXPECT_EQ(flow.height(flow.index(9, 10)), 100);
}

TEST(MaterialFlow, WhatIsCompactedIsNotSetDownAnyMore) {
  MaterialFlow flow = level();
  press(flow, 4, 4, 800);
  press(flow, 14, 14, 1600);
  flow.compact(1600);  // all of the first footprint's, half of the second's
  EXPECT_EQ(flow.in_transit(), 800);
  flow.deposit();
  EXPECT_EQ(flow.in_transit(), 0);
  EXPECT_EQ(volume(flow), -1600);
  EXPECT_EQ(flow.height(flow.index(5, 4)), 0);
  EXPECT_EQ(flow.height(flow.index(15, 14)), 100);
}

TEST(MaterialFlow, WhatFindsNoFreeNeighbourWaitsForALaterFootprint) {
  MaterialFlow flow(HeightField(2, 2, kSpacing_m, false), kRepose_deg);
  const size_t footprint = flow.begin_footprint(0.0, 0.0);
  for (int iy = 0; iy < 2; ++iy) {
    for (int ix = 0; ix < 2; ++ix) flow.cover(flow.index(ix, iy), ix, iy);
  }
  flow.sink(footprint, 0, 0, 0, 30);
  flow.deposit();
  EXPECT_EQ(flow.in_transit(), 30);
  EXPECT_EQ(volume(flow), -30);
  flow.uncover();
  // A part of what waits is compacted, the rest set down with the next footprint's.
  flow.compact(6);
  EXPECT_EQ(flow.in_transit(), 24);
  press(flow, 0, 0, 6);
  flow.deposit();
  EXPECT_EQ(flow.in_transit(), 0);
  EXPECT_EQ(volume(flow), -6);
  EXPECT_EQ(flow.height(flow.index(1, 1)), 10);
}

TEST(MaterialFlow, TwoFootprintsDoNotSetDownUnderEachOther) {
  MaterialFlow flow = level();
  press(flow, 10, 10, 700);
  press(flow, 11, 10, 700);
  flow.deposit();
  EXPECT_EQ(flow.in_transit(), 0);
  EXPECT_EQ(volume(flow), 0);
  EXPECT_EQ(flow.height(flow.index(10, 10)), -700);
  EXPECT_EQ(flow.height(flow.index(11, 10)), -700);
  EXPECT_EQ(flow.height(flow.index(9, 10)), 100);
  EXPECT_EQ(flow.height(flow.index(12, 10)), 100);
  EXPECT_EQ(flow.height(flow.index(10, 9)), 200) << "a neighbour of both";
}

TEST(MaterialFlow, ANodeIsFoundAcrossTheEdgeOfAFieldThatRepeatsAndNotOfOneThatDoesNot) {
  const MaterialFlow wrapped = level(5, true);
  EXPECT_EQ(wrapped.node_at(-1, 0), 4);
  EXPECT_EQ(wrapped.node_at(5, -1), 20);
  EXPECT_EQ(wrapped.node_at(-6, 12), 14);
  const MaterialFlow edged = level(5);
  EXPECT_EQ(edged.node_at(4, 4), 24);
  for (const auto& [ix, iy] : {std::pair{-1, 0}, {5, 0}, {0, -1}, {0, 5}}) {
    EXPECT_EQ(edged.node_at(ix, iy), -1) << ix << " " << iy;
  }
}

// ---- slopes

/// The greatest stable difference in height between neighbours, in units.
Height stable(double distance_m) {
  return static_cast<Height>(
      std::floor(std::tan(kRepose_deg * M_PI / 180.0) * distance_m / kHeightUnit_m));
}

/// A level field with one node raised; all slopes are to be looked at, or that node's alone.
MaterialFlow with_peak(Height units, bool all = true) {
  HeightField surface(21, 21, kSpacing_m, false);
  surface.set_node(10, 10, units);
  MaterialFlow flow(std::move(surface), kRepose_deg);
  if (all) {
    flow.enqueue_all();
  } else {
    flow.cover(flow.index(10, 10), 10, 10);
    flow.uncover();
  }
  return flow;
}

TEST(MaterialFlow, ASlopeAtTheAngleOfReposeStaysAndASteeperOneSlides) {
  const Height limit = stable(kSpacing_m);
  MaterialFlow stays = with_peak(limit + 1);  // one unit cannot be halved
  EXPECT_EQ(stays.slide(1000), 0);
  EXPECT_EQ(stays.queued(), 0U);
  MaterialFlow slides = with_peak(limit + 2);
  EXPECT_EQ(slides.slide(1000), 1);
  EXPECT_EQ(slides.height(slides.index(10, 10)), limit + 1);
  EXPECT_EQ(volume(slides), limit + 2);
  MaterialFlow hole = with_peak(-limit - 2);
  EXPECT_EQ(hole.slide(1000), 1);
  EXPECT_EQ(hole.height(hole.index(10, 10)), -limit - 1);
  EXPECT_EQ(volume(hole), -limit - 2);
}

TEST(MaterialFlow, HalfOfWhatIsTooMuchSlidesAndTheReferenceGoesAlong) {
  const Height limit = stable(kSpacing_m);
  MaterialFlow flow = with_peak(limit + 1000, false);
  EXPECT_EQ(flow.slide(1), 4) << "a node is finished once it is begun";
  const size_t east = flow.index(11, 10);
  EXPECT_EQ(flow.height(east), 500);
  EXPECT_EQ(flow.reference(east), 500);
  EXPECT_EQ(flow.height(flow.index(9, 10)), 250);
}

TEST(MaterialFlow, AllSlopesSettleBelowTheAngleOfReposeAlsoDiagonally) {
  const Height straight = stable(kSpacing_m);
  const Height diagonal = stable(kSpacing_m * std::sqrt(2.0));
  MaterialFlow flow = with_peak(20 * straight);
  while (flow.slide(100000) > 0) {
  }
  EXPECT_EQ(flow.queued(), 0U);
  EXPECT_EQ(volume(flow), 20 * straight);
  Height steepest_diagonal = 0;
  for (int iy = 0; iy < 20; ++iy) {
    for (int ix = 0; ix < 20; ++ix) {
      const Height here = flow.height(flow.index(ix, iy));
      EXPECT_LE(std::abs(here - flow.height(flow.index(ix + 1, iy))), straight + 1);
      EXPECT_LE(std::abs(here - flow.height(flow.index(ix, iy + 1))), straight + 1);
      const Height across = std::abs(here - flow.height(flow.index(ix + 1, iy + 1)));
      EXPECT_LE(across, diagonal + 1);
      steepest_diagonal = std::max(steepest_diagonal, across);
    }
  }
  EXPECT_GT(steepest_diagonal, straight + 1) << "a diagonal neighbour is farther away";
}

TEST(MaterialFlow, NothingSlidesOntoOrOffANodeThatABodyStandsOnUntilItIsGone) {
  const Height limit = stable(kSpacing_m);
  MaterialFlow flow = with_peak(limit + 1000);
  flow.cover(flow.index(10, 10), 10, 10);
  EXPECT_EQ(flow.slide(1000), 0);
  flow.uncover();
  EXPECT_TRUE(flow.is_queued(flow.index(10, 10)));
  EXPECT_GT(flow.slide(1000), 0);
}

TEST(MaterialFlow, SlidesNoMoreOftenThanItMay) {
  MaterialFlow flow = with_peak(20 * stable(kSpacing_m));
  int64_t all = 0;
  for (int64_t moves = 1; moves != 0; all += moves) {
    moves = flow.slide(10);
    ASSERT_LE(moves, 10 + 7) << "a node has eight neighbours";
  }
  EXPECT_GT(all, 20);
  EXPECT_EQ(flow.queued(), 0U);
}

// ---- digging

DugPatch patch_at(double x, double y) {
  return {{x, y}, {1.0, 0.0}, 2.0 * kSpacing_m, 1.0 * kSpacing_m, 3.0 * kSpacing_m};
}

TEST(MaterialFlow, DigsWhereTheFootprintSlipsInProportionToIt) {
  MaterialFlow flow = level();
  flow.begin_footprint(0.0, 0.0);
  flow.shear(flow.index(10, 10), 1.0);
  flow.shear(flow.index(11, 10), 3.0);
  EXPECT_EQ(flow.dig(patch_at(0.0, 0.0), 400, 100), 100);
  EXPECT_EQ(flow.height(flow.index(10, 10)), -100);
  EXPECT_EQ(flow.height(flow.index(11, 10)), -300);
  EXPECT_EQ(flow.reference(flow.index(11, 10)), -300) << "a hole, and no sinkage";
  EXPECT_EQ(flow.in_transit(), 300);
}

TEST(MaterialFlow, DigsToTheLastUnitWhereItDoesNotDivide) {
  MaterialFlow flow = level();
  flow.begin_footprint(0.0, 0.0);
  for (int i = 0; i < 7; ++i) flow.shear(flow.index(7 + i, 10), 1.0);
  EXPECT_EQ(flow.dig(patch_at(0.0, 0.0), 100, 0), 0);
  EXPECT_EQ(volume(flow), -100);
  for (int i = 0; i < 7; ++i) EXPECT_NEAR(flow.height(flow.index(7 + i, 10)), -14, 1) << i;
}

TEST(MaterialFlow, WithoutSlipOrWithNothingToTakeNothingIsDug) {
  MaterialFlow flow = level();
  flow.begin_footprint(0.0, 0.0);
  flow.shear(flow.index(10, 10), 0.0);
  EXPECT_EQ(flow.dig(patch_at(0.0, 0.0), 400, 100), 0);
  flow.shear(flow.index(10, 10), 1.0);
  EXPECT_EQ(flow.dig(patch_at(0.0, 0.0), 0, 0), 0);
  EXPECT_EQ(volume(flow), 0);
  EXPECT_EQ(flow.in_transit(), 0);
  // What was sheared then is forgotten.
  flow.shear(flow.index(3, 3), 1.0);
  flow.dig(patch_at(0.0, 0.0), 10, 10);
  EXPECT_EQ(flow.height(flow.index(10, 10)), 0);
  EXPECT_EQ(flow.height(flow.index(3, 3)), -10);
}

// As on a bed that moves no material: nothing is deposited, steps end all the same.
TEST(MaterialFlow, WhatIsDugAndCompactedLeavesNothingToLaterSteps) {
  MaterialFlow flow = level(41);
  MaterialFlow fresh = level(41);
  const size_t dug = flow.index(20, 20);
  flow.begin_footprint(0.0, 0.0);
  flow.shear(dug, 1.0);
  EXPECT_EQ(flow.dig(patch_at(0.02, -0.03), 480, 480), 480);
  flow.uncover();
  for (MaterialFlow* either : {&flow, &fresh}) {
    either->begin_footprint(0.0, 0.0);
    either->shear(dug, 1.0);
    either->dig(patch_at(0.02, -0.03), 480, 0);
    either->deposit();
    either->uncover();
  }
  for (size_t node = 0; node < flow.nodes(); ++node) {
    EXPECT_EQ(flow.height(node), fresh.height(node) - (node == dug ? 480 : 0)) << node;
  }
}

TEST(MaterialFlow, WhatIsDugIsHeapedUpInABandRoundTheFootprintAndNotInsideIt) {
  MaterialFlow flow = level(41);
  DugPatch patch = patch_at(0.02, -0.03);
  patch.forward = {0.6, 0.8};
  const Eigen::Vector2d side(-0.8, 0.6);
  for (int step = 0; step < 400; ++step) {
    flow.begin_footprint(0.0, 0.0);
    flow.shear(flow.index(20, 20), 1.0);
    flow.dig(patch, 480, 0);
    flow.deposit();
    ASSERT_EQ(flow.in_transit(), 0);
    flow.uncover();
  }
  ASSERT_EQ(volume(flow), 0);
  // Fills the hole.
  flow.sink(flow.begin_footprint(0.0, 0.0), flow.index(20, 20), 20, 20, -480 * 400);
  double along_sum = 0.0;
  double across_sum = 0.0;
  Height least = INT32_MAX;
  Height most = 0;
  for (int iy = 0; iy < 41; ++iy) {
    for (int ix = 0; ix < 41; ++ix) {
      const Eigen::Vector2d at(flow.surface().node_x(ix), flow.surface().node_y(iy));
      const Eigen::Vector2d from = at - patch.centre;
      const double along = std::abs(from.dot(patch.forward));
      const double across = std::abs(from.dot(side));
      const Height height = flow.height(flow.index(ix, iy));
      along_sum += height * from.dot(patch.forward);
      across_sum += height * from.dot(side);
      const double rounding = 0.75 * kSpacing_m;  // a place's nearest node is half a diagonal away
      if (along > patch.half_length + patch.band + rounding ||
          across > patch.half_width + patch.band + rounding) {
        EXPECT_EQ(height, 0) << "beyond the band: " << at.transpose();
      } else if (along < patch.half_length - rounding && across < patch.half_width - rounding) {
        EXPECT_EQ(height, 0) << "below the footprint: " << at.transpose();
      } else if ((along > patch.half_length + rounding || across > patch.half_width + rounding) &&
                 along < patch.half_length + patch.band - rounding &&
                 across < patch.half_width + patch.band - rounding) {
        least = std::min(least, height);
        most = std::max(most, height);
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
