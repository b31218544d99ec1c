// Attitudes of rotations and back.
#include "host_sim/physics/vehicle/vehicle_state.h"

#include <algorithm>
#include <cmath>

#include "host_sim/core/elementary.h"
#include "host_sim/core/rotation.h"

namespace screed {

Attitude attitude_of(const Eigen::Matrix3d& r) {
  return {portable::atan2(r(2, 1), r(2, 2)), portable::asin(std::clamp(r(2, 0), -1.0, 1.0)),
          portable::atan2(r(1, 0), r(0, 0))};
}

Eigen::Matrix3d rotation_from(const Attitude& attitude) {
  // Nose up is a negative turn about y, which points left; left side up is a positive turn about x.
  return (rotation_about(Eigen::Vector3d::UnitZ(), attitude.heading) *
          rotation_about(Eigen::Vector3d::UnitY(), -attitude.pitch) *
          rotation_about(Eigen::Vector3d::UnitX(), attitude.roll))
      .toRotationMatrix();
}

}  // namespace screed
