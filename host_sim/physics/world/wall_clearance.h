// Where robots may stand: between the walls of a bed, and not in one another.
#pragma once

#include <Eigen/Geometry>

#include "host_sim/physics/terrain/terrain.h"

namespace screed {

/// By how much a robot must be moved so that it is beyond no wall of the bed, m; zero on a bed
/// without walls. `outline`: the rectangle round it from above.
Eigen::Vector2d out_of_walls(const BedBounds& bed, const Eigen::AlignedBox2d& outline);

/// Throws InputError, with the places that are allowed, when robot `number` of `robots`, which
/// starts at `start`, would stand in a wall of the bed.
void check_between_walls(const BedBounds& bed, const Eigen::AlignedBox2d& outline,
                         const Eigen::Vector2d& start, size_t number, size_t robots);

/// Throws InputError: robots `one` and `other` of `robots` start in one another.
[[noreturn]] void refuse_overlap(size_t one, size_t other, size_t robots);

}  // namespace screed
