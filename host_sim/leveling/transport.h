// The least work that would still level a surface: optimal transport of the ground above its mean
// height into what lies below it.
//
// Ground that stands above the mean height has to go where ground is missing; a plan says how much
// goes from where to where. Of all plans the cheapest is found, on a grid of blocks:
//
//     T  = W1   = min sum m_ij d_ij     d_ij: distance in the plane, on wrapped terrain round its
//     edges T2 = W2^2 = min sum m_ij d_ij^2
//
// with m_ij >= 0, the sum over j equal to the excess of block i, that over i to the lack of block j
// (Kantorovich 1942; a minimum-cost flow).
#pragma once

#include <vector>

#include "host_sim/physics/terrain/height_field.h"

namespace screed {

/// Blocks along the longer side of a bed: 24 x 24 solve in some 20 ms.
inline constexpr int kTransportBlocks = 24;

/// A block of nodes, and the ground in it above the mean height.
struct GroundBlock {
  double x_m = 0.0;  ///< its centre
  double y_m = 0.0;
  double excess_m3 = 0.0;  ///< less than 0: missing
};

/// A surface on a coarse grid, each node standing for a cell of it.
struct GroundBlocks {
  std::vector<GroundBlock> blocks;
  double width_m = 0.0;  ///< of the bed
  double length_m = 0.0;
  bool wrap = false;
  /// The error of W1 by the coarse grid is at most this, m3 m: the work of carrying every node's
  /// excess to its block's centre (W1 is a norm of the excess, so the triangle inequality holds).
  double w1_error = 0.0;
};

/// blocks: along the longer side, 1 or more, of equal size but for one node; at most one a node.
/// Throws InputError for less than 1.
GroundBlocks ground_blocks(const HeightField& surface, int blocks = kTransportBlocks);

/// W1 of the blocks, m3 m. The same blocks give the same bits: the problem is solved in integers,
/// of 2^-40 of the volume and 2^-30 of the bed's size.
double least_transport(const GroundBlocks& ground);
/// W2^2, m3 m2, likewise.
double least_squared_transport(const GroundBlocks& ground);

}  // namespace screed
