// Attitudes of rotations and back.
#include "host_sim/physics/vehicle/vehicle_state.h"

#include <algorithm>
#include <cmath>

namespace screed {

Attitude attitude_of(const Eigen::Matrix3d& r) {
  return {std::atan2(r(2, 1), r(2, 2)), std::asin(std::clamp(r(2, 0), -1.0, 1.0)),
          std::atan2(r(1, 0), r(0, 0))};
}

Eigen::Matrix3d rotation_from(const Attitude& attitude) {
  // Nose up is a negative turn about y, which points left; left side up is a positive turn about x.
  return (Eigen::AngleAxisd(attitude.heading, Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(-attitude.pitch, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(attitude.roll, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

}  // namespace screed
