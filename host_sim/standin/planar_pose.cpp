#include "host_sim/standin/planar_pose.h"

#include <Eigen/Geometry>
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

TrackGeometry track_geometry(const Assembly& robot, const VehicleOptions& options) {
  TrackGeometry tracks;
  tracks.lug_height_m = options.lugs_m();
  tracks.friction = options.track_friction;
  const auto& [front, rear] = robot.wheels[0];
  const Eigen::Vector3d& at = front.centre;
  tracks.half_length_m = 0.5 * (at.x() - rear.centre.x());
  tracks.half_tread_m = at.y();
  tracks.radius_m = front.radius_m;
  tracks.width_m = front.width_m;
  tracks.below_m = tracks.radius_m - at.z();
  double mass = 0.0;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const AssemblyBody& body : robot.bodies) {
    mass += body.inertia.mass;
    centre += body.inertia.mass * (body.pose * body.inertia.pose.translation());
  }
  centre /= mass;
  double inertia = 0.0;
  for (const AssemblyBody& body : robot.bodies) {
    const Eigen::Isometry3d pose = body.pose * body.inertia.pose;
    const Eigen::Vector3d up = pose.linear().row(2);
    inertia += up.dot(body.inertia.tensor * up) +
               body.inertia.mass * (pose.translation() - centre).head<2>().squaredNorm();
  }
  tracks.mass_kg = mass;
  tracks.mass_ahead_m = centre.x();
  tracks.mass_height_m = centre.z() + tracks.below_m;
  tracks.yaw_inertia_kg_m2 = inertia;
  return tracks;
}

}  // namespace screed
