#include "host_sim/standin/track_geometry.h"

#include <Eigen/Geometry>

namespace screed {

TrackGeometry track_geometry(const Assembly& robot) {
  TrackGeometry tracks;
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
