// The motion that a robot's sensors measure, without their errors.
#pragma once

#include <Eigen/Geometry>

namespace screed {

/// True motion over the last tick.
struct ImuTruth {
  Eigen::Vector3d mean_rate_rad_per_s;  ///< body frame
  Eigen::Vector3d mean_specific_force;  ///< body frame, m/s^2: acceleration minus gravity
  Eigen::Matrix3d body_to_world;
  double altitude_m;
};

}  // namespace screed
