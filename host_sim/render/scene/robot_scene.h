// A robot as part of a POV-Ray scene: the bodies of its model, its wheels or tracks turned as far
// as they have turned. Knows models and poses, no sessions and no ground.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <string>

#include "host_sim/physics/vehicle/assembly.h"

namespace screed {

struct RobotPose {
  Eigen::Isometry3d body = Eigen::Isometry3d::Identity();  ///< chassis to world
  std::array<double, 2>
      travel_m{};  ///< of the left and right running gear's surface since the start
};

/// Joints stand as in the model. The shapes are the model's `visual` ones; treads, spokes and
/// colours are the drawer's.
std::string robot_text(const Assembly& assembly, bool tracks, const RobotPose& pose);

}  // namespace screed
