// Slopes that slide: at the edges of fields of all sizes, across seams, in small portions.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "tests/unit/host_sim/physics/soil/level_material.h"

namespace screed {
namespace {

/// A field without wrap-around, or with it, on which one node is raised: settled.
MaterialFlow settled_peak(int nx, int ny, bool wrap, int ix, int iy, Height units) {
  HeightField surface(nx, ny, kSpacing_m, wrap);
  surface.set_node(ix, iy, units);
  MaterialFlow flow(std::move(surface), kRepose_deg);
  flow.enqueue_all();
  while (flow.slide(1000000) > 0) {
  }
  return flow;
}

/// The steepest slope beyond the stable one between any neighbours, units.
Height beyond_stable(const MaterialFlow& flow) {
  Height most = 0;
  for (int iy = 0; iy < flow.grid().surface().ny(); ++iy) {
    for (int ix = 0; ix < flow.grid().surface().nx(); ++ix) {
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          GridNode beside{0, ix + dx, iy + dy};
          if (!flow.grid().find(beside)) continue;
          const double distance_m = kSpacing_m * (dx != 0 && dy != 0 ? std::sqrt(2.0) : 1.0);
          const Height fall = height(flow, ix, iy) - flow.grid().height(beside.node);
          most = std::max(most, fall - stable(distance_m));
        }
      }
    }
  }
  return most;
}

TEST(MaterialSlides, FieldsOfAllSizesSettleToTheirEdges) {
  const Height peak = 6 * stable(kSpacing_m);
  for (const bool wrap : {false, true}) {
    for (int ny = 2; ny <= 12; ++ny) {
      for (int nx = 2; nx <= 12; ++nx) {
        for (const int ix : {0, nx / 2, nx - 1}) {
          const MaterialFlow flow = settled_peak(nx, ny, wrap, ix, ny - 1, peak);
          ASSERT_EQ(volume(flow), peak) << nx << " " << ny << " " << ix;
          ASSERT_LE(beyond_stable(flow), 1) << nx << " " << ny << " " << ix;
          ASSERT_EQ(flow.queued(), 0U);
        }
      }
    }
  }
}

TEST(MaterialSlides, AFieldThatRepeatsSettlesAcrossItsSeamAsInItsMiddle) {
  const Height peak = 5 * stable(kSpacing_m);
  HeightField surface(16, 12, kSpacing_m, true);
  surface.set_node(0, 0, peak);
  HeightField same(16, 12, kSpacing_m, true);
  same.set_node(8, 6, peak);
  MaterialFlow at_seam(std::move(surface), kRepose_deg);
  MaterialFlow in_middle(std::move(same), kRepose_deg);
  for (const auto& [flow, ix, iy] : {std::tuple{&at_seam, 0, 0}, std::tuple{&in_middle, 8, 6}}) {
    flow->cover(flow->grid().place(ix, iy));
    flow->uncover();
    while (flow->slide(1000000) > 0) {
    }
  }
  for (int iy = 0; iy < 12; ++iy) {
    for (int ix = 0; ix < 16; ++ix) {
      EXPECT_EQ(at_seam.grid().height(at_seam.grid().node(ix - 8, iy - 6)),
                height(in_middle, ix, iy))
          << ix << " " << iy;
    }
  }
}

TEST(MaterialSlides, TheCornerTakesWhatSlidesAlongTheEdge) {
  HeightField surface(5, 5, kSpacing_m, false);
  surface.set_node(1, 0, 10 * stable(kSpacing_m));
  MaterialFlow flow(std::move(surface), kRepose_deg);
  flow.cover(flow.grid().place(1, 0));
  flow.uncover();
  EXPECT_EQ(flow.slide(1), 5) << "a node at the edge has five neighbours";
  EXPECT_GT(height(flow, 0, 0), 0);
}

TEST(MaterialSlides, SlidingInPortionsEndsAsSlidingAtOnce) {
  const Height peak = 20 * stable(kSpacing_m);
  const MaterialFlow at_once = settled_peak(21, 21, false, 10, 10, peak);
  for (const int64_t portion : {1, 2, 7, 100}) {
    HeightField surface(21, 21, kSpacing_m, false);
    surface.set_node(10, 10, peak);
    MaterialFlow flow(std::move(surface), kRepose_deg);
    flow.enqueue_all();
    for (int step = 0; flow.queued() > 0; ++step) {
      ASSERT_LT(step, 1000000);
      if (flow.slide(portion) == 0) break;
    }
    EXPECT_EQ(flow.queued(), 0U) << portion;
    for (size_t node = 0; node < flow.grid().size(); ++node) {
      ASSERT_EQ(flow.grid().height(node), at_once.grid().height(node)) << portion << ": " << node;
      ASSERT_FALSE(flow.is_queued(node)) << portion << ": " << node;
    }
  }
}

TEST(MaterialSlides, WithoutAnyMoveWhatIsToSlideWaits) {
  MaterialFlow flow = settled_peak(21, 21, false, 10, 10, 20 * stable(kSpacing_m));
  flow.shear(flow.grid().node(2, 2), 1.0);
  flow.dig({}, 1000000);
  EXPECT_EQ(flow.slide(0), 0);
  EXPECT_EQ(flow.queued(), 1U);
  EXPECT_EQ(flow.slide(1), 8) << "the slopes of the hole";
}

TEST(MaterialSlides, ANodeThatWaitsAlreadyDoesNotWaitTwice) {
  MaterialFlow flow = level(5);
  flow.shear(flow.grid().node(2, 2), 1.0);
  flow.dig({}, 10);
  ASSERT_EQ(flow.queued(), 1U);
  flow.enqueue_all();
  EXPECT_EQ(flow.queued(), 25U);
  flow.enqueue_all();
  EXPECT_EQ(flow.queued(), 25U);
}

}  // namespace
}  // namespace screed
