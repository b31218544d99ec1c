// Light and shade on a height map.
#pragma once

#include <algorithm>
#include <cmath>

namespace screed {

/// dz/dx and dz/dy, rise over run.
struct Relief {
  double x;
  double y;
};

/// Lambert's law for light from the north-west, 45 degrees high; 1 = as bright as level ground.
inline double light(const Relief& slope, double exaggeration) {
  const double gx = slope.x * exaggeration;
  const double gy = slope.y * exaggeration;
  constexpr double kHalfRoot = 0.70710678118654752440;
  // Towards the light: (-1/2, 1/2, 1/sqrt 2); the surface's normal: (-gx, -gy, 1).
  const double toward = 0.5 * gx - 0.5 * gy + kHalfRoot;
  const double facing = toward / std::sqrt(gx * gx + gy * gy + 1.0);
  return std::max(0.0, facing) / kHalfRoot;
}

}  // namespace screed
