// The robot from above, as its model says.
#pragma once

#include <vector>

#include "host_sim/physics/vehicle/assembly.h"

namespace screed::viewer {

/// A rectangle in the robot's frame, m: x forward, y left.
struct Plate {
  double back;
  double front;
  double right;
  double left;
};

struct RobotShape {
  Plate hull{};
  std::vector<Plate> running_gear;  ///< tracks, or wheels: those of the left side first
  size_t left_gear = 0;             ///< how many of them are on the left
};

/// Throws InputError when the model has no wheels to draw. tracks: tracks round the wheels.
RobotShape shape_of(const Assembly& robot, bool tracks);

}  // namespace screed::viewer
