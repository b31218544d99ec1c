// Volumes are summed in integers, so that they are exact; squares always in the same order.
#include "host_sim/physics/terrain/terrain_change.h"

#include <algorithm>
#include <cmath>

#include "host_sim/core/errors.h"
#include "host_sim/physics/terrain/low_pass.h"

namespace screed {

TerrainChange terrain_change(const HeightField& before, const HeightField& after) {
  if (before.nx() != after.nx() || before.ny() != after.ny() ||
      before.spacing_m() != after.spacing_m() || before.wrap() != after.wrap()) {
    throw InputError("terrain change: the terrains before and after differ in their grid");
  }
  int64_t cut = 0;
  int64_t fill = 0;
  int64_t lowest = 0;
  int64_t highest = 0;
  const size_t nodes = static_cast<size_t>(before.nx()) * static_cast<size_t>(before.ny());
  for (size_t node = 0; node < nodes; ++node) {
    const int64_t change = int64_t{after.node(node)} - before.node(node);
    if (change < 0) {
      cut -= change;
    } else {
      fill += change;
    }
    lowest = std::min(lowest, change);
    highest = std::max(highest, change);
  }
  const double unit_m3 = kHeightUnit_m * before.spacing_m() * before.spacing_m();
  return {static_cast<double>(cut) * unit_m3, static_cast<double>(fill) * unit_m3,
          static_cast<double>(-lowest) * kHeightUnit_m,
          static_cast<double>(highest) * kHeightUnit_m};
}

RobotScaleRelief robot_scale_relief(const HeightField& field) {
  const FilteredHeights heights = filter_heights(field, kRobotScale_m);
  double relief = 0.0;
  double roughness = 0.0;
  for (size_t node = 0; node < heights.low_m.size(); ++node) {
    const double low = heights.low_m[node];
    const double rest = heights.heights_m[node] - low;
    relief += low * low;
    roughness += rest * rest;
  }
  const auto count = static_cast<double>(heights.low_m.size());
  return {std::sqrt(relief / count), std::sqrt(roughness / count)};
}

}  // namespace screed
