#include "host_sim/standin/planar_pose.h"

#include <cmath>

#include "host_sim/core/elementary.h"

namespace screed {

void PlanarPose::move(const FrameMotion& motion) {
  const double middle = heading_rad + 0.5 * motion.turn_rad;
  const auto [s, c] = portable::sine_cosine(middle);
  x_m += motion.forward_m * c - motion.sideways_m * s;
  y_m += motion.forward_m * s + motion.sideways_m * c;
  heading_rad += motion.turn_rad;
}

FrameMotion PlanarPose::since(const PlanarPose& earlier) const {
  const auto [s, c] = portable::sine_cosine(heading_rad);
  const double dx = x_m - earlier.x_m;
  const double dy = y_m - earlier.y_m;
  return {c * dx + s * dy, c * dy - s * dx, heading_rad - earlier.heading_rad};
}

}  // namespace screed
