// Where material goes: slopes that slide, and what is carried past a footprint.
#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

#include "tests/unit/host_sim/physics/soil/level_material.h"

namespace screed {

namespace {

// Slopes that slide: at the edges of fields of all sizes, across seams, in small portions.

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

// What is dug and carried past a footprint: how the places found for it share it.

constexpr double kFine_m = 0.0005;

struct HeapedPlace {
  Eigen::Vector2d from;  // from the patch's centre, along and across it
  double units;
};

/// What one step of digging `units` in the field's north-east corner lays elsewhere.
std::vector<HeapedPlace> heap_up(MaterialFlow& flow, const DugPatch& patch, int64_t units) {
  const HeightField& surface = flow.grid().surface();
  const int nx = surface.nx();
  const size_t hole = flow.grid().size() - 1;
  std::vector<Height> before(flow.grid().size());
  for (size_t node = 0; node < flow.grid().size(); ++node) before[node] = flow.grid().height(node);
  flow.shear(hole, 1.0);
  flow.dig(patch, units);
  flow.deposit();
  flow.uncover();
  const Eigen::Vector2d side(-patch.forward.y(), patch.forward.x());
  std::vector<HeapedPlace> places;
  for (size_t node = 0; node < hole; ++node) {
    const Height laid = flow.grid().height(node) - before[node];
    if (laid == 0) continue;
    const auto place = static_cast<int>(node);
    const Eigen::Vector2d at(surface.node_x(place % nx), surface.node_y(place / nx));
    const Eigen::Vector2d from = at - patch.centre;
    places.push_back({{from.dot(patch.forward), from.dot(side)}, static_cast<double>(laid)});
  }
  return places;
}

/// Mean square of the distance along (0) or across (1) over the whole band, by adding it up.
double square_of_band(const DugPatch& patch, int axis) {
  constexpr int kSteps = 200;
  const Eigen::Vector2d inner(patch.half_length, patch.half_width);
  const Eigen::Vector2d outer = inner.array() + patch.band;
  double sum = 0.0;
  int count = 0;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const Eigen::Vector2d at((2.0 * i + 1.0) / kSteps * outer.x() - outer.x(),
                               (2.0 * j + 1.0) / kSteps * outer.y() - outer.y());
      if (std::abs(at.x()) < inner.x() && std::abs(at.y()) < inner.y()) continue;
      sum += at[axis] * at[axis];
      ++count;
    }
  }
  return sum / count;
}

// Of the band only the strip beyond one of its sides lies on the field. So near to each other its
// places cannot carry as far as asked for; they do as though they were spread half as far as the
// band's.
TEST(MaterialCarried, FewPlacesSideBySideCarryNoFurtherThanAQuarterOfTheBandsSquares) {
  for (const int axis : {0, 1}) {
    for (const double way : {-1.0, 1.0}) {
      MaterialFlow flow(HeightField(401, 401, kFine_m, false), kRepose_deg);
      DugPatch patch{{0.0, 0.0}, {0.0, 1.0}, 0.06, 0.05, 0.03};
      if (axis == 0) patch.forward = {1.0, 0.0};
      // East is forward, or to its right: against the axis across.
      patch.centre.x() = flow.grid().surface().x_min() - (axis == 0 ? 0.06 : 0.05);
      constexpr double kCarried = 5e4;  // units m
      patch.carried = {way * kCarried, 0.0};
      const double signed_carried = axis == 0 ? way * kCarried : -way * kCarried;
      const std::vector<HeapedPlace> places = heap_up(flow, patch, 1000000);
      ASSERT_EQ(flow.in_transit(), 0);
      ASSERT_EQ(volume(flow), 0);
      const auto count = static_cast<double>(places.size());
      ASSERT_GE(count, 5.0);
      double mean = 0.0;
      for (const HeapedPlace& place : places) mean += place.from[axis] / count;
      const double per_m = signed_carried / (0.25 * square_of_band(patch, axis)) / count;
      for (const HeapedPlace& place : places) {
        EXPECT_NEAR(place.units, 1e6 / count + (place.from[axis] - mean) * per_m,
                    0.75 * kFine_m * std::abs(per_m))
            << axis << " " << way << ": " << place.from.transpose();
      }
    }
  }
}

TEST(MaterialCarried, AStepInWhichNothingIsDugCarriesNothing) {
  MaterialFlow flow = level();
  DugPatch patch{{0.0, 0.0}, {1.0, 0.0}, 2.0 * kSpacing_m, kSpacing_m, 3.0 * kSpacing_m};
  patch.carried = {1e4, 1e4};
  flow.shear(flow.grid().node(10, 10), 1.0);
  flow.dig(patch, 0);
  flow.deposit();
  for (size_t node = 0; node < flow.grid().size(); ++node)
    EXPECT_EQ(flow.grid().height(node), 0) << node;
  EXPECT_EQ(flow.queued(), 0U);
}

// Of R2's sequence (Roberts 2018) also many places lie farther apart than half the spacing of a
// square grid of as many.
TEST(MaterialCarried, ThePlacesOfManyStepsLieFarApart) {
  constexpr double kSide_m = 0.2;
  constexpr int kSteps = 5;
  MaterialFlow flow(HeightField(401, 401, kFine_m, false), kRepose_deg);
  const DugPatch patch{{0.0, 0.0}, {1.0, 0.0}, 0.0, 0.0, 0.5 * kSide_m};
  std::vector<Eigen::Vector2d> places;
  for (int step = 0; step < kSteps; ++step) {
    for (const HeapedPlace& place : heap_up(flow, patch, 480)) places.push_back(place.from);
  }
  const auto count = static_cast<double>(places.size());
  ASSERT_GE(count, 48.0 * kSteps - 1.0);
  double nearest_m = kSide_m;
  for (size_t i = 0; i < places.size(); ++i) {
    for (size_t j = 0; j < i; ++j) nearest_m = std::min(nearest_m, (places[i] - places[j]).norm());
  }
  EXPECT_GT(nearest_m, 0.5 * kSide_m / std::sqrt(count));
}

}  // namespace

}  // namespace screed
