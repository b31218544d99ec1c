// A robot in the middle of a drive: what it takes to go on from there.
#pragma once

#include <array>

#include "host_sim/physics/vehicle/battery.h"
#include "host_sim/standin/planar_pose.h"

namespace screed {

struct DrivingState {
  PlanarPose pose;
  FrameMotion last;  ///< of the last frame
  std::array<double, 2> track_speed_m_per_s{};
  std::array<double, 2> shaft_angle_rad{};
  Battery battery;
};

}  // namespace screed
