// What a run has done to a terrain, in numbers: volumes, depths, and the relief at the scale of the
// robot.
#pragma once

#include "host_sim/physics/terrain/height_field.h"

namespace screed {

/// From one terrain to another on the same grid. Every node stands for one cell of it.
struct TerrainChange {
  double cut_m3 = 0.0;          ///< by which the ground is lower, where it is lower
  double fill_m3 = 0.0;         ///< by which it is higher, where it is higher
  double deepest_cut_m = 0.0;   ///< >= 0
  double deepest_fill_m = 0.0;  ///< >= 0
  /// The ground that lies elsewhere now. The rest of the cut is compacted (or has left the bed),
  /// the rest of the fill has loosened.
  [[nodiscard]] double moved_m3() const { return cut_m3 < fill_m3 ? cut_m3 : fill_m3; }
};

/// Throws InputError when the two differ in their grid.
TerrainChange terrain_change(const HeightField& before, const HeightField& after);

/// Standard deviation of the low-pass that parts relief from roughness: half the robot's width, m.
inline constexpr double kRobotScale_m = 0.05;

/// Root mean squares over the nodes, m, of the heights above the mean plane (low_pass.h).
struct RobotScaleRelief {
  double relief_m = 0.0;     ///< of what a low-pass of kRobotScale_m leaves: what a robot drives up
  double roughness_m = 0.0;  ///< of what it takes away: ruts, ridges, single stones
};

RobotScaleRelief robot_scale_relief(const HeightField& field);

}  // namespace screed
