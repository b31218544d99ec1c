// The point of a body's surface that is nearest to another point, in closed form: for the shapes
// that press on the ground (footprint.h), from any side.
#pragma once

#include <Eigen/Core>

#include "host_sim/physics/terrain/footprint.h"

namespace screed {

/// In the footprint's local axes.
struct SolidContact {
  double distance;          ///< from the surface to the point, m; negative inside
  Eigen::Vector3d normal;   ///< out of the body, unit length
  Eigen::Vector3d surface;  ///< the nearest point of the surface
  /// How fast a belt or rim moves there when its surface speed is 1, driving forward; zero on
  /// bodies without one.
  Eigen::Vector3d belt;
};

SolidContact nearest_on(const Footprint& solid, const Eigen::Vector3d& point);

}  // namespace screed
