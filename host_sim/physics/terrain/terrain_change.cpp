// Volumes are summed in integers, so that they are exact.
#include "host_sim/physics/terrain/terrain_change.h"

#include <algorithm>

#include "host_sim/core/errors.h"

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

}  // namespace screed
