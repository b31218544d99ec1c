// Lays a bed of equal spheres below a surface (thesis 5.1.3): a stack a pixel, each as high as the
// surface says, placed sphere by sphere where it finds a hollow.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "host_sim/core/task_progress.h"
#include "host_sim/physics/terrain/height_field.h"

namespace screed {

/// Extent of a bed: a whole number of stacks, one particle wide, round (0, 0).
struct BedExtent {
  int stacks_x = 0;
  int stacks_y = 0;
  double width_m = 0.0;
  double depth_m = 0.0;
  bool periodic = false;  ///< no side walls: the bed repeats
};

BedExtent bed_extent(const HeightField& top, double radius_m);

/// Particles in each stack, row by row from the south: the surface's height in its middle over the
/// particle's diameter, rounded. The floor is at height 0. Throws InputError when there are none,
/// or more than 4 million.
std::vector<int> stack_counts(const HeightField& top, const BedExtent& extent, double radius_m);

/// Centres of the particles: layer after layer, in each layer one stack after the other in random
/// order, each particle is let down near the middle of its stack and rolls into the hollow that it
/// finds there. None overlap; each rests on others, the floor or a wall. They are numbered in
/// square tiles, 16 stacks wide, and in a tile stack by stack: who lies near has a near number.
/// Reports the task "laying particles".
std::vector<Eigen::Vector3d> lay_spheres(const std::vector<int>& counts, const BedExtent& extent,
                                         double radius_m, uint64_t seed,
                                         const TaskProgress& progress = {});

}  // namespace screed
