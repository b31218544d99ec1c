// Where material that is pressed down is laid: on the nodes round its footprint, in which order.
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "tests/unit/host_sim/physics/soil/level_material.h"

namespace screed {
namespace {

using Outline = std::set<std::pair<int, int>>;  // nodes of a footprint

Outline filled_outline(int width, int height) {
  Outline outline;
  for (int iy = 0; iy < height; ++iy) {
    for (int ix = 0; ix < width; ++ix) outline.insert({ix, iy});
  }
  return outline;
}

/// Nodes that mostly stand alone, in other columns with each `shift`.
Outline sparse_outline(int width, int height, int shift) {
  Outline outline{{0, 0}, {width - 1, height - 1}};
  for (const auto& [ix, iy] : filled_outline(width, height)) {
    if ((ix + shift + 4 * iy) % 11 == 0) outline.insert({ix, iy});
  }
  return outline;
}

/// The nodes beside those of an outline, also at a corner.
Outline ring_round(const Outline& outline) {
  Outline ring;
  for (const auto& [ix, iy] : outline) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if (!outline.contains({ix + dx, iy + dy})) ring.insert({ix + dx, iy + dy});
      }
    }
  }
  return ring;
}

/// Sets a footprint down with its outline's (0, 0) at a node, presses 100 units for each node
/// beside it, and looks where they lie afterwards.
void expect_laid_round(MaterialFlow& flow, const Outline& outline, int first_x, int first_y) {
  constexpr Height kEach = 100;
  const Outline ring = ring_round(outline);
  std::vector<Height> expected(flow.grid().size());
  for (size_t node = 0; node < flow.grid().size(); ++node)
    expected[node] = flow.grid().height(node);
  const auto at = [&](const std::pair<int, int>& place) {
    return flow.grid().place(first_x + place.first, first_y + place.second);
  };
  for (const auto& place : ring) expected[at(place).node] += kEach;
  const auto pressed = static_cast<Height>(ring.size()) * kEach;
  expected[at(*outline.begin()).node] -= pressed;
  flow.begin_footprint();
  for (const auto& place : outline) flow.cover(at(place));
  flow.sink(at(*outline.begin()), pressed);
  flow.deposit();
  flow.uncover();
  EXPECT_EQ(flow.in_transit(), 0);
  for (size_t node = 0; node < flow.grid().size(); ++node) {
    ASSERT_EQ(flow.grid().height(node), expected[node]) << node << " of " << outline.size();
  }
}

MaterialFlow wide_level(bool wrap = false) {
  return {HeightField(300, 24, kSpacing_m, wrap), kRepose_deg};
}

TEST(MaterialRing, AFootprintOfAnyWidthHasAllNodesBesideIt) {
  for (const int width : {1, 2, 31, 55, 61, 62, 63, 64, 65, 66, 126, 127, 128, 129, 130, 200}) {
    MaterialFlow flow = wide_level();
    expect_laid_round(flow, filled_outline(width, 3), 20, 5);
  }
}

TEST(MaterialRing, ScatteredNodesOfAFootprintHaveAllNodesBesideEachOfThem) {
  for (int shift = 0; shift < 11; ++shift) {
    MaterialFlow flow = wide_level();
    expect_laid_round(flow, sparse_outline(140 + shift, 6, shift), 20, 5);
  }
}

TEST(MaterialRing, ASmallFootprintGetsNothingOfTheLargerOnesBefore) {
  MaterialFlow flow = wide_level();
  for (int height = 1; height <= 10; ++height) {
    expect_laid_round(flow, filled_outline(200, 12), 20, 5);
    expect_laid_round(flow, filled_outline(5, height), 20, 5);
    expect_laid_round(flow, sparse_outline(200, 12, height), 20, 5);
    expect_laid_round(flow, filled_outline(70, height), 20, 5);
  }
}

TEST(MaterialRing, ALargeFootprintMayFollowASmallOne) {
  for (const int width : {70, 130, 200, 270}) {
    MaterialFlow flow = wide_level();
    expect_laid_round(flow, filled_outline(1, 1), 20, 5);
    expect_laid_round(flow, filled_outline(width, 1), 20, 5);
    expect_laid_round(flow, sparse_outline(width, 14, 3), 20, 5);
  }
}

TEST(MaterialRing, AFootprintAcrossTheSeamOfAFieldThatRepeatsHasAllNodesBesideIt) {
  MaterialFlow flow = wide_level(true);
  expect_laid_round(flow, filled_outline(100, 5), 250, 22);
  expect_laid_round(flow, sparse_outline(100, 5, 4), -50, -3);
}

TEST(MaterialRing, WhatIsDugWaitsBesideAFootprintThatTouchesNothing) {
  MaterialFlow flow = level();
  flow.begin_footprint();
  flow.shear(flow.grid().node(10, 10), 1.0);
  flow.dig({{0.0, 0.0}, {1.0, 0.0}, 2.0 * kSpacing_m, kSpacing_m, 0.0}, 80);
  flow.deposit();
  EXPECT_EQ(flow.in_transit(), 80);
  flow.uncover();
  press(flow, 4, 4, 0);
  flow.deposit();
  EXPECT_EQ(flow.in_transit(), 0);
  EXPECT_EQ(height(flow, 5, 5), 10);
}

TEST(MaterialRing, ASingleUnitFillsARut) {
  MaterialFlow flow = level();
  const GridNode rut = flow.grid().place(10, 10);
  flow.grid().set_height(rut, -800);
  flow.grid()[rut.node].sunk = 800;
  press(flow, 11, 10, 8);  // one for each neighbour
  flow.deposit();
  EXPECT_EQ(flow.grid().height(rut.node), -799);
  EXPECT_EQ(flow.grid()[rut.node].sunk, 799);
}

// ---- shares

/// A footprint of one row along x, pressed down at its first node.
void press_row(MaterialFlow& flow, int length, double reach, Height units) {
  flow.begin_footprint({{0.0, 0.0}, {1.0, 0.0}, reach});
  for (int i = 0; i < length; ++i) flow.cover(flow.grid().place(10 + i, 2));
  flow.sink(flow.grid().place(10, 2), units);
}

TEST(MaterialRing, WhatAFootprintDidNotPressItselfIsSharedOutEqually) {
  MaterialFlow flow = wide_level();
  constexpr int kRing = 2 * 32 + 2;
  press(flow, 200, 12, 100 * kRing);
  flow.uncover();  // nobody has deposited it
  press_row(flow, 30, 0.01, 0);
  flow.deposit();
  EXPECT_EQ(flow.in_transit(), 0);
  for (int ix = 9; ix <= 40; ++ix) {
    for (const int iy : {1, 3}) {
      EXPECT_NEAR(height(flow, ix, iy), 100, 1) << ix << " " << iy;
    }
  }
  EXPECT_NEAR(height(flow, 9, 2), 100, 1);
  EXPECT_NEAR(height(flow, 40, 2), 100, 1);
}

TEST(MaterialRing, ASingleUnitIsLaidBesideWhereItWasPressed) {
  MaterialFlow flow = wide_level();
  press(flow, 200, 12, 1);  // of the first turn the threshold is 0: its last place takes all
  flow.deposit();
  flow.uncover();
  for (int step = 0; step < 50; ++step) {
    press_row(flow, 100, kSpacing_m, 1);
    flow.deposit();
    flow.uncover();
  }
  // At one spacing of reach less than exp(-20) of it comes farther than twenty.
  int64_t near = 0;
  for (int ix = 9; ix < 30; ++ix) {
    for (const int iy : {1, 3}) near += height(flow, ix, iy);
  }
  EXPECT_EQ(near + height(flow, 9, 2), 50);
}

/// The last steps of MurmurHash3, as published.
uint32_t murmur_of(uint32_t key) {
  key ^= key >> 16U;
  key *= 0x85EBCA6BU;
  key ^= key >> 13U;
  key *= 0xC2B2AE35U;
  return key ^ (key >> 16U);
}

/// A footprint of 94 x 94 nodes that stand apart, so that it has 70688 neighbours: what it presses
/// is a remainder that moves the turn on.
void skip_turns(MaterialFlow& flow, Height turns) {
  flow.begin_footprint();
  for (int iy = 1; iy < 283; iy += 3) {
    for (int ix = 1; ix < 283; ix += 3) flow.cover(flow.grid().place(ix, iy));
  }
  flow.sink(flow.grid().place(1, 1), turns);
  flow.deposit();
  flow.uncover();
}

// Recorded runs are compared bit by bit, so a step's threshold is a promise: the hash of its turn.
TEST(MaterialRing, WhereASingleUnitOfEqualSharesIsLaidFollowsTheHashOfTheTurn) {
  ASSERT_EQ(murmur_of(1), 0x514E28B7U);
  constexpr int kLength = 64;
  constexpr int kRing = 2 * (kLength + 2) + 2;
  constexpr double kEndless_m = 1e12;                // from end to end: equal shares
  const std::vector<uint32_t> beginnings{0, 70000};  // turns of less and of more than 16 bits
  for (const uint32_t beginning : beginnings) {
    MaterialFlow flow = level(284);
    if (beginning > 0) skip_turns(flow, static_cast<Height>(beginning));
    std::vector<size_t> ring;  // row by row
    for (int iy = 1; iy <= 3; ++iy) {
      for (int ix = 9; ix <= 10 + kLength; ++ix) {
        if (iy != 2 || ix == 9 || ix == 10 + kLength) ring.push_back(flow.grid().node(ix, iy));
      }
    }
    ASSERT_EQ(ring.size(), size_t{kRing});
    for (uint32_t step = 0; step < 3000; ++step) {
      press_row(flow, kLength, kEndless_m, 1);
      // The first place at which the threshold and the shares so far make a whole.
      const double missing = 1.0 - murmur_of(beginning + step) / 4294967296.0;
      const auto place = static_cast<size_t>(std::ceil(missing * kRing)) - 1;
      const Height before = flow.grid().height(ring[place]);
      flow.deposit();
      ASSERT_EQ(flow.grid().height(ring[place]), before + 1) << beginning << " " << step;
      flow.uncover();
    }
  }
}

}  // namespace
}  // namespace screed
