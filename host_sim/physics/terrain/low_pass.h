// A Gaussian low-pass over samples on a grid.
#pragma once

#include <cstdint>
#include <vector>

#include "host_sim/physics/terrain/height_field.h"

namespace screed {

/// What a filter finds beyond the edge of its samples.
enum class FilterEdge : uint8_t {
  kWrapped,    ///< the samples again: those of repeating terrain
  kReflected,  ///< their mirror image (c b a | a b c), so that their sum stays as it is
  kRepeated,   ///< the sample at the edge, again and again
};

/// Filters width x height samples, row by row, along both directions. sigma: standard deviation in
/// samples, more than 0; weights end at 4 sigma and add up to 1. The same samples give the same
/// bits.
void gaussian_filter(std::vector<double>& samples, int width, int height, double sigma,
                     FilterEdge edge);

// The surface of a terrain after a Gaussian low-pass: its relief without what is small.

/// A plane over a bed: height_m + slope_x x + slope_y y.
struct MeanPlane {
  double height_m = 0.0;
  double slope_x = 0.0;
  double slope_y = 0.0;
  [[nodiscard]] double at(double x, double y) const { return height_m + slope_x * x + slope_y * y; }
};

/// The plane of least squares through the nodes. On wrapped terrain it is level: the mean slope of
/// a surface that repeats is 0.
MeanPlane mean_plane(const HeightField& field);

/// Heights above the mean plane at the nodes, row by row from the south, metres, as they are and
/// after a Gaussian low-pass: periodic on wrapped terrain, else with reflection at the edges.
struct FilteredHeights {
  MeanPlane plane;
  std::vector<double> heights_m;
  std::vector<double> low_m;
};

/// sigma_m: standard deviation on the ground, 0.0001..100 m. Throws InputError outside of it.
FilteredHeights filter_heights(const HeightField& field, double sigma_m);

/// The surface after the low-pass, on its plane again: a plane stays as it is. Throws as above.
HeightField low_passed(const HeightField& field, double sigma_m);

}  // namespace screed
