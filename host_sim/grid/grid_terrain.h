// Terrains of the grid world: heights of stacks in units, made of noise or read from an image.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "host_sim/core/random.h"

namespace screed {

/// The largest side of a grid, cells.
inline constexpr int kLargestGridSide = 4096;

enum class GridBorder {
  kWalls,  ///< steps out of the grid fail
  kTorus,  ///< opposite sides touch
};

struct GridTerrain {
  int width = 0;                  ///< cells in x, 1..kLargestGridSide
  int height = 0;                 ///< cells in y
  std::vector<uint16_t> heights;  ///< units, row by row, 0..kMaxStackHeight

  [[nodiscard]] uint64_t sum() const;
};

struct NoiseParameters {
  int width = 32;
  int height = 32;
  double mean = 6.5;       ///< units; the sum of all heights is round(mean * cells)
  double amplitude = 5.0;  ///< units, of the highest or lowest place before rounding
  double lattice = 10.0;   ///< cells between two lattice points of the noise
  GridBorder border = GridBorder::kWalls;  ///< on a torus the noise wraps as well: the lattice is
                                           ///< stretched to a whole number of periods
};

/// One octave of Perlin's gradient noise (K. Perlin, "Improving noise", 2002; gradients of any
/// direction), shifted to mean 0 and scaled to greatest magnitude 1, f; heights round(mean +
/// amplitude f), at least 0; then single units are added or removed at random places until the sum
/// is exact. The same generator gives the same terrain.
GridTerrain noise_terrain(const NoiseParameters& parameters, WorldRandom& random);

/// A grey image as terrain: black is 0, white is `white` units, rounded; each cell is the mean of
/// the pixels it covers. width and height 0: a cell a pixel. Row 0 of the image is the row of
/// greatest y. Throws InputError as read_grey_image() does, and when the grid would be larger than
/// kLargestGridSide or finer than the image.
GridTerrain image_terrain(const std::filesystem::path& path, int width, int height, double white);

/// Adds or removes single units at random places (nothing below 0) until the sum is `sum`.
void adjust_sum(GridTerrain& terrain, uint64_t sum, WorldRandom& random);

}  // namespace screed
