// The particles of a bed as plain data, for those who record or draw them.
#pragma once

#include <array>
#include <vector>

namespace screed {

/// Equal spheres; none on terrain that is not made of them.
struct SphereSet {
  double radius_m = 0.0;
  std::vector<std::array<float, 3>> centers_m;  ///< x, y, z in the world
};

}  // namespace screed
