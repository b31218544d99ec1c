// What is dug and carried past a footprint: how the places found for it share it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/unit/host_sim/physics/soil/level_material.h"

namespace screed {
namespace {

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
