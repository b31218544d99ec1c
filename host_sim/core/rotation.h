// Rotations by angles and back, of portable bits: Eigen's own call the C library's transcendental
// functions.
#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "host_sim/core/elementary.h"

namespace screed {

/// In the plane, anticlockwise; its transpose turns back.
inline Eigen::Matrix2d rotation_by(double angle_rad) {
  const auto [sine, cosine] = portable::sine_cosine(angle_rad);
  Eigen::Matrix2d rotation;
  rotation << cosine, -sine, sine, cosine;
  return rotation;
}

/// About `axis`, of length 1.
inline Eigen::Quaterniond rotation_about(const Eigen::Vector3d& axis, double angle_rad) {
  const auto [sine, cosine] = portable::sine_cosine(0.5 * angle_rad);
  return {cosine, sine * axis.x(), sine * axis.y(), sine * axis.z()};
}

/// Its axis times its angle: at most half a turn, rad.
inline Eigen::Vector3d rotation_vector(const Eigen::Quaterniond& rotation) {
  const double sine = rotation.vec().norm();
  if (sine == 0.0) return Eigen::Vector3d::Zero();
  const double angle_rad = 2.0 * portable::atan2(sine, std::abs(rotation.w()));
  return std::copysign(angle_rad, rotation.w()) / sine * rotation.vec();
}

}  // namespace screed
