// What a run has done to a terrain, in numbers: volumes and depths.
#pragma once

#include "host_sim/physics/terrain/height_field.h"

namespace screed {

/// From one terrain to another on the same grid. Every node stands for one cell of it.
struct TerrainChange {
  double cut_m3 = 0.0;          ///< by which the ground is lower, where it is lower
  double fill_m3 = 0.0;         ///< by which it is higher, where it is higher
  double deepest_cut_m = 0.0;   ///< >= 0
  double deepest_fill_m = 0.0;  ///< >= 0
  /// Whether every height is what it was.
  [[nodiscard]] bool is_none() const { return cut_m3 == 0.0 && fill_m3 == 0.0; }
  /// The ground that lies elsewhere now. The rest of the cut is compacted (or has left the bed),
  /// the rest of the fill has loosened.
  [[nodiscard]] double moved_m3() const { return cut_m3 < fill_m3 ? cut_m3 : fill_m3; }
};

/// Throws InputError when the two differ in their grid.
TerrainChange terrain_change(const HeightField& before, const HeightField& after);

}  // namespace screed
