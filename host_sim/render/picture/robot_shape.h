// The robot from above, as its model says.
#pragma once

#include <vector>

#include "host_sim/physics/vehicle/assembly.h"

namespace screed {

/// A rectangle in the robot's frame, m: x forward, y left.
struct RobotPlate {
  double back;
  double front;
  double right;
  double left;
};

struct RobotShape {
  RobotPlate hull{};
  std::vector<RobotPlate> running_gear;  ///< tracks, or wheels: those of the left side first
  size_t left_gear = 0;                  ///< how many of them are on the left
};

/// tracks: tracks round the wheels.
RobotShape shape_of(const Assembly& robot, bool tracks);

}  // namespace screed
