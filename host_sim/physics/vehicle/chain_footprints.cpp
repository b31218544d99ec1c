// A track of links as terrain meets it by footprints: one band round the wheels, or a box a link.
#include <algorithm>
#include <cmath>

#include "host_sim/physics/vehicle/chain_track.h"

namespace screed {
namespace {

// Elements that push on one link at a time, about: they are larger than links.
constexpr double kContactsOnALink = 2.0;

}  // namespace

double ChainTrack::surface_speed(const PlaneFrame& frame) const {
  double speed = 0.0;
  for (size_t i = 0; i < pins(); ++i) {
    const Vector2 ahead = (position_[after(i)] - position_[before(i)]).normalized();
    speed += ahead.dot(
        frame.in_plane(velocity_[i] - frame.carrier_velocity(frame.to_world(position_[i]))));
  }
  return speed / static_cast<double>(pins());
}

ChainTrack::Link ChainTrack::link(size_t i) const {
  const Vector2 run = position_[after(i)] - position_[i];
  const double length = run.norm();
  const Vector2 along = run / length;
  const Vector2 out(-along.y(), along.x());
  return {along, length, out, -0.5 * kChainShoeThickness_m * out};
}

FootprintContact ChainTrack::band_contact(const CarrierMotion& carrier) {
  const PlaneFrame frame = frame_of(carrier);
  const bool on_its_side = std::abs(frame.axes(2, 1)) > kOnItsSide;
  Footprint& footprint = on_its_side ? side_footprint_ : footprint_;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = frame.axes;
  pose.translation() = frame.centre;
  footprint.set_pose(pose);
  FootprintContact contact;
  contact.footprint = &footprint;
  contact.memory = &memory_;
  contact.arm = frame.centre - carrier.origin;
  FootprintMotion& motion = contact.motion;
  motion.velocity = frame.carrier_velocity(frame.centre);
  motion.omega = carrier.omega;
  motion.friction = law_.friction;
  motion.lug_height_m = geometry_.lug_height_m;
  if (on_its_side || at_rest_) return contact;
  motion.surface_speed = surface_speed(frame);
  motion.slip = signed_slip(motion.surface_speed, motion.velocity.dot(frame.axes.col(0)));
  return contact;
}

// Every link is a box to loose elements.
FootprintContact ChainTrack::shoe_contact(const PlaneFrame& frame, size_t i) {
  const size_t j = after(i);
  const Link shoe = link(i);
  const Vector2 run = position_[j] - position_[i];
  const Eigen::Vector3d axle = frame.axes.col(1);
  Eigen::Isometry3d pose;
  pose.linear() << frame.from_plane(shoe.along), axle, frame.from_plane(shoe.out);
  pose.translation() = frame.to_world(position_[i] + 0.5 * run + shoe.inwards);
  shoes_[i].set_pose(pose);
  FootprintContact contact;
  contact.footprint = &shoes_[i];
  contact.arm = pose.translation() - frame.carrier.origin;
  FootprintMotion& motion = contact.motion;
  motion.friction = law_.friction;
  const Eigen::Vector3d& carried = frame.carrier.omega;
  const double turning = -shoe.out.dot(frame.in_plane(velocity_[j] - velocity_[i])) / shoe.length;
  motion.omega = carried + (turning - axle.dot(carried)) * axle;
  const Eigen::Vector3d pins_velocity = 0.5 * (velocity_[i] + velocity_[j]);
  motion.velocity =
      pins_velocity + axle.dot(frame.carrier_velocity(pose.translation()) - pins_velocity) * axle;
  motion.velocity += (turning * axle).cross(frame.from_plane(shoe.inwards));
  return contact;
}

// What drives along the band goes into the pins of the lower run; the rest goes straight into the
// body, through wheels and guides that are stiff beside the terrain. The body has got all of it
// already.
void ChainTrack::pull_on_lower_run(const TerrainReaction& band, const PlaneFrame& frame, double dt,
                                   Wrench& wrench) {
  normal_load_ = band.normal_load;
  sinkage_ = band.sinkage;
  if (std::abs(frame.axes(2, 1)) > kOnItsSide) return;
  const double below = frame.axes(2, 2) < 0.0 ? 1.0 : -1.0;
  const auto in_lower_run = [&](const Vector2& pin) {
    return pin.y() * below > 0.0 && std::abs(pin.x()) <= half_length_;
  };
  const auto lower = std::count_if(position_.begin(), position_.end(), in_lower_run);
  const Vector2 each(band.force.dot(frame.axes.col(0)) / static_cast<double>(lower), 0.0);
  for (size_t i = 0; i < pins(); ++i) {
    if (!in_lower_run(position_[i])) continue;
    solver_.right[i] += dt * each;
    wrench.add(-frame.from_plane(each), frame.to_world(position_[i]) - frame.carrier.origin);
  }
}

// Elements push on a link with stiff springs of their own: the pins take them as if the springs
// were implicit, which only a change of their velocity feels.
void ChainTrack::push_shoes(std::span<const FootprintContact> shoes,
                            const ContactStiffness& stiffness, const PlaneFrame& frame, double dt,
                            Wrench& wrench) {
  const double gain =
      kContactsOnALink * (stiffness.damping_n_s_per_m + dt * stiffness.stiffness_n_per_m);
  const Eigen::Vector3d axle = frame.axes.col(1);
  for (size_t i = 0; i < shoes.size(); ++i) {
    const TerrainReaction& reaction = shoes[i].reaction;
    if (reaction.force.isZero(0.0)) continue;
    const size_t j = after(i);
    const Link shoe = link(i);
    const Vector2 force = frame.in_plane(reaction.force);
    const double about_axle = axle.dot(reaction.torque);
    // About the left axis a force at (x, z) has the moment z Fx - x Fz.
    const double moment = about_axle + shoe.inwards.y() * force.x() - shoe.inwards.x() * force.y();
    const Vector2 couple = -moment / shoe.length * shoe.out;
    const Matrix2 each = 0.5 * gain * Matrix2::Identity();
    add_force(i, 0.5 * force - couple, each, dt);
    add_force(j, 0.5 * force + couple, each, dt);
    terrain_force_[i] += 0.5 * reaction.force;
    terrain_force_[j] += 0.5 * reaction.force;
    wrench.torque += reaction.torque - about_axle * axle;
    normal_load_ += reaction.normal_load;
  }
}

}  // namespace screed
