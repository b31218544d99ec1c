// A few frames of a drive, after which a network says what they did to the ground.
#pragma once

#include <array>
#include <cstdint>

#include "host_sim/physics/vehicle/assembly.h"

namespace screed::nn {

/// Frames of a stride: 50 ms, in which the robot comes about as far as a cell of the ground.
inline constexpr std::uint64_t kStrideFrames = 5;
inline constexpr double kStrideRate_hz = 100.0 / kStrideFrames;

/// Where a wheel stands under the robot, m: x forward, y left.
struct WheelPosition {
  double x = 0.0;
  double y = 0.0;
  double radius_m = 0.0;
  bool front = false;
};
/// Front left, front right, rear left, rear right.
std::array<WheelPosition, 4> wheel_positions(const Assembly& robot);

struct Stride {
  double x_m = 0.0;  ///< at its end, on the bed
  double y_m = 0.0;
  double yaw_rad = 0.0;
  double forward_m = 0.0;  ///< during it, in the robot's axes at its end
  double sideways_m = 0.0;
  double turn_rad = 0.0;
  std::array<double, 2> track_m{};  ///< travel of the wheels' surfaces, left and right
  double v_left = 0.0;              ///< Table 5.1, at its end: rad/s, rad
  double v_right = 0.0;
  double pitch = 0.0;
  double roll = 0.0;
};

}  // namespace screed::nn
