// Material on its way: what is in hand, how it is shared out round footprints, what slides.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/unit/host_sim/physics/soil/level_material.h"

namespace screed {
namespace {

TEST(MaterialFlow, WhatSinksIsInHandUntilItIsSetDownRoundTheFootprint) {
  MaterialFlow flow = level();
  press(flow, 10, 10, 800);
  EXPECT_EQ(flow.in_transit(), 800);
  EXPECT_EQ(volume(flow), -800);
  flow.deposit();
  EXPECT_EQ(flow.in_transit(), 0);
  EXPECT_EQ(volume(flow), 0);
  EXPECT_EQ(height(flow, 10, 10), -800);
  EXPECT_EQ(flow.grid().reference(flow.grid().node(10, 10)), 0)
      << "sinkage counts from where the ground was";
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (dx == 0 && dy == 0) continue;
      EXPECT_EQ(height(flow, 10 + dx, 10 + dy), 100) << dx << " " << dy;
      EXPECT_EQ(flow.grid().reference(flow.grid().node(10 + dx, 10 + dy)), 100);
    }
  }
}

// What is pressed beside a rut is deposited in it, too.
TEST(MaterialFlow, WhatFillsARutIsLooseAndLiesOnWhatIsPressed) {
  MaterialFlow flow = level();
  const size_t rut = flow.grid().node(10, 10);
  press(flow, 10, 10, 800);
  flow.deposit();
  flow.uncover();
  press(flow, 11, 10, 8 * 500);  // an eighth to each neighbour
  flow.deposit();
  flow.uncover();
  EXPECT_EQ(flow.grid().height(rut), -300);
  EXPECT_EQ(flow.grid()[rut].sunk, 300) << "of 800 units 500 are filled";
  EXPECT_EQ(flow.grid().reference(rut), 0);
  press(flow, 9, 10, 8 * 450);
  flow.deposit();
  EXPECT_EQ(flow.grid().height(rut), 150);
  EXPECT_EQ(flow.grid()[rut].sunk, 0);
  EXPECT_EQ(flow.grid().reference(rut), 150);
}

TEST(MaterialFlow, WhatDoesNotDivideGoesToOtherNeighboursEachTime) {
  for (const Height units : {9, 11, 15}) {
    MaterialFlow flow = level();
    for (int step = 0; step < 8; ++step) {
      press(flow, 10, 10, units);
      flow.deposit();
      ASSERT_EQ(flow.in_transit(), 0);
      ASSERT_EQ(volume(flow), 0);
      flow.uncover();
    }
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if (dx == 0 && dy == 0) continue;
        EXPECT_EQ(height(flow, 10 + dx, 10 + dy), units) << dx << " " << dy;
      }
    }
  }
}

TEST(MaterialFlow, AStepForgetsTheFootprintsOfTheOneBeforeButNotTheirMaterial) {
  MaterialFlow flow = level();
  press(flow, 10, 10, 80);
  flow.uncover();
  EXPECT_EQ(flow.in_transit(), 80) << "nobody has deposited it";
  press(flow, 4, 4, 8);
  flow.deposit();
  EXPECT_EQ(flow.in_transit(), 0);
  EXPECT_EQ(height(flow, 5, 4), 11);
  EXPECT_EQ(height(flow, 11, 10), 0);
  flow.uncover();
  while (flow.slide(1000) > 0) {
  }
  press(flow, 15, 15, 0);
  flow.uncover();
  EXPECT_FALSE(flow.is_queued(flow.grid().node(4, 4))) << "its body was there in another step";
}

TEST(MaterialFlow, NothingIsSetDownOnTheWayOfAMovingFootprint) {
  for (const double speed : {0.01, 2.0}) {
    MaterialFlow flow = level();
    press(flow, 10, 10, 500, speed, 0.0);
    flow.deposit();
    for (int dy = -1; dy <= 1; ++dy) {
      EXPECT_EQ(height(flow, 9, 10 + dy), 0) << speed;
      EXPECT_EQ(height(flow, 11, 10 + dy), 0) << speed;
    }
    EXPECT_EQ(height(flow, 10, 9), 250);
    EXPECT_EQ(height(flow, 10, 11), 250);
  }
  // Across, and against the axes.
  MaterialFlow flow = level();
  press(flow, 10, 10, 500, 0.0, -0.3);
  flow.deposit();
  EXPECT_EQ(height(flow, 10, 11), 0);
  EXPECT_EQ(height(flow, 10, 9), 0);
  EXPECT_EQ(height(flow, 9, 10), 250);
}

TEST(MaterialFlow, TheRutOfADiagonalWayLiesBehindItAtAnySpeed) {
  // Nothing lies beside this node but ahead or behind: then it goes ahead. Ahead of or beside the
  // line through the node at right angles to the way is not behind.
  for (const double speed : {0.002, 0.5}) {
    MaterialFlow flow = level();
    press(flow, 10, 10, 400, 0.8 * speed, 0.6 * speed);
    flow.deposit();
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if (dx == 0 && dy == 0) continue;
        const bool behind = 0.8 * dx + 0.6 * dy < 0.0;
        EXPECT_EQ(height(flow, 10 + dx, 10 + dy), behind ? 0 : 100)
            << speed << ": " << dx << " " << dy;
      }
    }
  }
}

TEST(MaterialFlow, OnlyWhatGetsMaterialIsLookedAtAgain) {
  MaterialFlow flow = level();
  press(flow, 10, 10, 3);
  flow.deposit();
  EXPECT_EQ(flow.queued(), 3U) << "three neighbours";
  const size_t below = flow.grid().node(10, 10);
  EXPECT_FALSE(flow.is_queued(below)) << "it is held as long as the footprint stands there";
  flow.uncover();
  EXPECT_TRUE(flow.is_queued(below));
  flow.uncover();  // a step without it
  EXPECT_EQ(flow.queued(), 4U);
  flow.slide(1000);
  EXPECT_FALSE(flow.is_queued(below));
}

TEST(MaterialFlow, AFootprintThatHardlyMovesHasNoRutBehindIt) {
  for (const double speed : {0.0009, 0.001}) {
    MaterialFlow flow = level();
    press(flow, 10, 10, 800, speed, 0.0);
    flow.deposit();
    EXPECT_EQ(height(flow, 9, 10), 100) << speed;
  }
  MaterialFlow flow = level();
  press(flow, 10, 10, 500, 0.0011, 0.0);
  flow.deposit();
  EXPECT_EQ(height(flow, 9, 10), 0);
}

TEST(MaterialFlow, WhereAllIsBehindItTheRutIsFilled) {
  // A footprint as wide as the field drives off it.
  MaterialFlow flow = level(5);
  flow.begin_footprint({{0.1, 0.0}});
  for (int iy = 0; iy < 5; ++iy) flow.cover(flow.grid().place(4, iy));
  flow.sink(flow.grid().place(4, 2), 50);
  flow.deposit();
  EXPECT_EQ(flow.in_transit(), 0);
  for (int iy = 0; iy < 5; ++iy) EXPECT_EQ(height(flow, 3, iy), 10) << iy;
}

TEST(MaterialFlow, TheOnlyNeighbourThatIsNotBehindTakesAll) {
  MaterialFlow flow = level(5);
  flow.begin_footprint({{0.1, 0.0}});
  for (int iy = 0; iy < 5; ++iy) flow.cover(flow.grid().place(3, iy));
  for (int iy = 0; iy < 4; ++iy) flow.cover(flow.grid().place(4, iy));
  flow.sink(flow.grid().place(3, 2), 50);
  flow.deposit();
  EXPECT_EQ(height(flow, 4, 4), 50);
  EXPECT_EQ(height(flow, 2, 2), 0);
}

TEST(MaterialFlow, ASingleUnitIsDepositedAtOnceAndSoIsOneAtTheFieldsCorner) {
  MaterialFlow flow = level();
  press(flow, 10, 10, 1);
  flow.deposit();
  EXPECT_EQ(flow.in_transit(), 0);
  flow.uncover();
  press(flow, 1, 1, 800);
  flow.deposit();
  EXPECT_EQ(height(flow, 0, 0), 100) << "the first node is one, too";
}

TEST(MaterialFlow, TheReferenceBeginsAtTheSurface) {
  const HeightField surface = HeightField::from_function(
      4, 3, kSpacing_m, false, [](double x, double y) { return 0.3 + x + 2.0 * y; });
  const MaterialFlow flow(surface, kRepose_deg);
  for (size_t node = 0; node < flow.grid().size(); ++node) {
    EXPECT_EQ(flow.grid().reference(node), flow.grid().height(node)) << node;
    EXPECT_GT(flow.grid().reference(node), 0) << node;
  }
}

TEST(MaterialFlow, WhatIsCompactedIsNotSetDownAnyMore) {
  MaterialFlow flow = level(21, false, {0.5, 600.0 * kHeightUnit_m});
  press(flow, 4, 4, 800);
  press(flow, 14, 14, 1600);
  EXPECT_EQ(flow.compacted(), 400 + 600) << "half, and all that the second place may lose";
  EXPECT_EQ(flow.in_transit(), 400 + 1000);
  flow.deposit();
  EXPECT_EQ(flow.in_transit(), 0);
  EXPECT_EQ(volume(flow), -1000);
  EXPECT_EQ(height(flow, 5, 4), 50);
  EXPECT_EQ(height(flow, 15, 14), 125);
}

TEST(MaterialFlow, WhatFindsNoFreeNeighbourWaitsForALaterFootprint) {
  MaterialFlow flow(HeightField(2, 2, kSpacing_m, false), kRepose_deg);
  flow.begin_footprint();
  for (int iy = 0; iy < 2; ++iy) {
    for (int ix = 0; ix < 2; ++ix) flow.cover(flow.grid().place(ix, iy));
  }
  flow.sink({0, 0, 0}, 30);
  flow.deposit();
  EXPECT_EQ(flow.in_transit(), 30);
  EXPECT_EQ(volume(flow), -30);
  flow.uncover();
  press(flow, 0, 0, 6);
  flow.deposit();
  EXPECT_EQ(flow.in_transit(), 0);
  EXPECT_EQ(volume(flow), 0);
  EXPECT_EQ(height(flow, 1, 1), 12);
}

/// A footprint of 3 x `length` nodes from (10, 10) on, along x, pressed down at its first column.
void press_one_end(MaterialFlow& flow, int length, const PressedPatch& patch, Height units) {
  flow.begin_footprint(patch);
  for (int ix = 10; ix < 10 + length; ++ix) {
    for (int iy = 10; iy < 13; ++iy) flow.cover(flow.grid().place(ix, iy));
  }
  for (int iy = 10; iy < 13; ++iy) flow.sink(flow.grid().place(10, iy), units);
}

TEST(MaterialFlow, WhatIsPressedIsLaidBesideWhereItWas) {
  constexpr double kReach_m = 0.03;
  constexpr int kLength = 24;
  MaterialFlow flow = level(51);
  press_one_end(flow, kLength, {{0.0, 0.0}, {1.0, 0.0}, kReach_m}, 100000);
  flow.deposit();
  EXPECT_EQ(flow.in_transit(), 0);
  EXPECT_EQ(volume(flow), 0);
  // Beside it both rows have the same, less by exp(-distance / reach) with each column.
  const auto at = [&](int ix, int iy) { return static_cast<double>(height(flow, ix, iy)); };
  const double per_column = std::exp(-kSpacing_m / kReach_m);
  for (int ix = 10; ix < 9 + kLength; ++ix) {
    EXPECT_NEAR(at(ix, 9), at(ix, 13), 1.0) << ix;
    EXPECT_NEAR(at(ix + 1, 9), per_column * at(ix, 9), 2.0) << ix;
  }
  EXPECT_NEAR(at(9, 11), per_column * at(10, 9), 2.0) << "and so at its end";
  // Closed form: the ring has five nodes at either end, two beside each column.
  double weights = 5.0 * per_column + 5.0 * std::pow(per_column, kLength);
  for (int i = 0; i < kLength; ++i) weights += 2.0 * std::pow(per_column, i);
  EXPECT_NEAR(at(10, 9), 300000.0 / weights, 2.0);
}

TEST(MaterialFlow, ATiltedPresserCarriesHardlyAnythingToItsOtherEnd) {
  for (const double degrees : {0.0, 33.0, 90.0, 200.0}) {
    const double angle = degrees * 3.14159265358979 / 180.0;
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    MaterialFlow flow = level(61);
    flow.begin_footprint({{0.0, 0.0}, {c, s}, 0.03});
    const auto each_node = [&](const auto& visit) {
      for (int iy = 0; iy < 61; ++iy) {
        for (int ix = 0; ix < 61; ++ix) {
          const double along = (ix - 30) * c + (iy - 30) * s;
          const double across = (iy - 30) * c - (ix - 30) * s;
          visit(flow.grid().node(ix, iy), ix, iy, along,
                std::abs(along) <= 12.0 && std::abs(across) <= 1.6);
        }
      }
    };
    each_node([&](size_t node, int ix, int iy, double, bool below) {
      if (below) flow.cover({node, ix, iy});
    });
    each_node([&](size_t node, int ix, int iy, double along, bool below) {
      if (below && along < -6.0) flow.sink({node, ix, iy}, 10000);
    });
    const auto moved = static_cast<double>(flow.in_transit());
    flow.deposit();
    double near = 0.0;
    double far = 0.0;
    each_node([&](size_t node, int, int, double along, bool below) {
      if (below) return;
      if (along < -3.0) near += flow.grid().height(node);
      if (along > 3.0) far += flow.grid().height(node);
    });
    EXPECT_GT(near, 0.8 * moved) << degrees;
    EXPECT_LT(far, 0.04 * moved) << degrees;
    EXPECT_EQ(volume(flow), 0);
  }
}

TEST(MaterialFlow, AFewUnitsAreSharedOutAsManyAre) {
  const PressedPatch patch{{0.0, 0.0}, {1.0, 0.0}, 0.03};
  constexpr int kSteps = 40000;
  MaterialFlow flow = level(51);
  for (int step = 0; step < kSteps; ++step) {  // less than a unit for each place
    press_one_end(flow, 24, patch, 1 + step % 3);
    flow.deposit();
    flow.uncover();
  }
  MaterialFlow at_once = level(51);
  press_one_end(at_once, 24, patch, 2 * kSteps);
  at_once.deposit();
  for (int ix = 9; ix <= 34; ++ix) {
    const double expected = height(at_once, ix, 9);
    EXPECT_NEAR(height(flow, ix, 9), expected, 2.0 + 4.0 * std::sqrt(expected)) << ix;
  }
}

TEST(MaterialFlow, WhatComesFromOtherFootprintsIsLaidWhereThisOnePresses) {
  MaterialFlow flow = level(51);
  press(flow, 45, 45, 80);
  flow.uncover();  // nobody has deposited it
  press_one_end(flow, 24, {{0.0, 0.0}, {1.0, 0.0}, 0.01}, 1000);
  flow.deposit();
  EXPECT_EQ(volume(flow), 0);
  EXPECT_EQ(height(flow, 34, 11), 0);
  MaterialFlow none_of_its_own = level(51);
  press(none_of_its_own, 45, 45, 56 * 4);
  none_of_its_own.uncover();
  press_one_end(none_of_its_own, 24, {{0.0, 0.0}, {1.0, 0.0}, 0.01}, 0);
  none_of_its_own.deposit();
  EXPECT_EQ(volume(none_of_its_own), 0);
  EXPECT_GT(height(none_of_its_own, 34, 11), 0) << "in equal parts";
}

TEST(MaterialFlow, TwoFootprintsDoNotSetDownUnderEachOther) {
  MaterialFlow flow = level();
  press(flow, 10, 10, 700);
  press(flow, 11, 10, 700);
  flow.deposit();
  EXPECT_EQ(flow.in_transit(), 0);
  EXPECT_EQ(volume(flow), 0);
  EXPECT_EQ(height(flow, 10, 10), -700);
  EXPECT_EQ(height(flow, 11, 10), -700);
  EXPECT_EQ(height(flow, 9, 10), 100);
  EXPECT_EQ(height(flow, 12, 10), 100);
  EXPECT_EQ(height(flow, 10, 9), 200) << "a neighbour of both";
}

// ---- slopes

/// A level field with one node raised; all slopes are to be looked at, or that node's alone.
MaterialFlow with_peak(Height units, bool all = true) {
  HeightField surface(21, 21, kSpacing_m, false);
  surface.set_node(10, 10, units);
  MaterialFlow flow(std::move(surface), kRepose_deg);
  if (all) {
    flow.enqueue_all();
  } else {
    flow.cover(flow.grid().place(10, 10));
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
  EXPECT_EQ(height(slides, 10, 10), limit + 1);
  EXPECT_EQ(volume(slides), limit + 2);
  MaterialFlow hole = with_peak(-limit - 2);
  EXPECT_EQ(hole.slide(1000), 1);
  EXPECT_EQ(height(hole, 10, 10), -limit - 1);
  EXPECT_EQ(volume(hole), -limit - 2);
}

TEST(MaterialFlow, HalfOfWhatIsTooMuchSlidesAndTheReferenceGoesAlong) {
  const Height limit = stable(kSpacing_m);
  MaterialFlow flow = with_peak(limit + 1000, false);
  EXPECT_EQ(flow.slide(1), 4) << "a node is finished once it is begun";
  const size_t east = flow.grid().node(11, 10);
  EXPECT_EQ(flow.grid().height(east), 500);
  EXPECT_EQ(flow.grid().reference(east), 500);
  EXPECT_EQ(height(flow, 9, 10), 250);
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
      const Height here = height(flow, ix, iy);
      EXPECT_LE(std::abs(here - height(flow, ix + 1, iy)), straight + 1);
      EXPECT_LE(std::abs(here - height(flow, ix, iy + 1)), straight + 1);
      const Height across = std::abs(here - height(flow, ix + 1, iy + 1));
      EXPECT_LE(across, diagonal + 1);
      steepest_diagonal = std::max(steepest_diagonal, across);
    }
  }
  EXPECT_GT(steepest_diagonal, straight + 1) << "a diagonal neighbour is farther away";
}

TEST(MaterialFlow, AHoleFillsAlsoWhenItAloneIsLookedAt) {
  MaterialFlow flow = with_peak(-stable(kSpacing_m) - 1000, false);
  EXPECT_EQ(flow.slide(1), 4);
  EXPECT_EQ(height(flow, 11, 10), -500);
}

TEST(MaterialFlow, ANewBedIsLookedAtWholeOnlyWhenAsked) {
  MaterialFlow flow = level(5);
  EXPECT_EQ(flow.queued(), 0U);
  flow.enqueue_all();
  EXPECT_EQ(flow.queued(), 25U);
  for (size_t node = 0; node < flow.grid().size(); ++node)
    EXPECT_TRUE(flow.is_queued(node)) << node;
}

TEST(MaterialFlow, WhenNothingSlidesAnyMoreNoNodeWaits) {
  MaterialFlow flow = with_peak(40 * stable(kSpacing_m));
  while (flow.slide(1000) > 0) {
  }
  EXPECT_EQ(flow.queued(), 0U);
  for (size_t node = 0; node < flow.grid().size(); ++node)
    EXPECT_FALSE(flow.is_queued(node)) << node;
}

TEST(MaterialFlow, TheFirstNodeTakesWhatSlidesAsAnyOther) {
  HeightField surface(5, 5, kSpacing_m, false);
  surface.set_node(1, 1, 10 * stable(kSpacing_m));
  MaterialFlow flow(std::move(surface), kRepose_deg);
  flow.cover(flow.grid().place(1, 1));
  flow.uncover();
  EXPECT_EQ(flow.slide(1), 8) << "a node has eight neighbours";
  EXPECT_GT(height(flow, 0, 0), 0);
}

TEST(MaterialFlow, NothingSlidesOntoOrOffANodeThatABodyStandsOnUntilItIsGone) {
  const Height limit = stable(kSpacing_m);
  MaterialFlow flow = with_peak(limit + 1000);
  flow.cover(flow.grid().place(10, 10));
  EXPECT_EQ(flow.slide(1000), 0);
  flow.uncover();
  EXPECT_TRUE(flow.is_queued(flow.grid().node(10, 10)));
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
  // Exactly as often as it may: no other node is begun.
  MaterialFlow once = with_peak(20 * stable(kSpacing_m), false);
  const int64_t first = once.slide(1);
  MaterialFlow same = with_peak(20 * stable(kSpacing_m), false);
  EXPECT_EQ(same.slide(first), first);
}

}  // namespace
}  // namespace screed
