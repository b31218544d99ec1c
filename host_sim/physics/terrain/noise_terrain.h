// Made-up terrain: seeded noise that tiles, for training data on terrain without edges.
#pragma once

#include <cstdint>

#include "host_sim/physics/terrain/grey_image.h"

namespace screed {

struct NoiseTerrainOptions {
  uint64_t seed = 1;
  int size = 256;            ///< samples a side, 16..4096
  int waves = 4;             ///< hills and hollows along a side in the coarsest octave, 1..64
  int octaves = 4;           ///< each twice as fine as the one before, 1..10
  double persistence = 0.5;  ///< height of an octave as a share of that before, 0..1
};

/// A square 16-bit image that continues at its left edge where it ends at the right, and at its top
/// where it ends at the bottom; from black to white. Sum of octaves of gradient noise (Perlin,
/// Improving Noise, 2002) on lattices that repeat. Same options, same samples on every machine.
/// Throws InputError for options out of range.
GreyImage noise_terrain(const NoiseTerrainOptions& options);

}  // namespace screed
