// Four wheels under one body.
#include "host_sim/soil_validation/soil_robot.h"

#include <algorithm>
#include <limits>

#include "host_sim/core/content_hash.h"

namespace screed {
namespace {}  // namespace

SoilRobot::SoilRobot(SoilBed& bed, const SoilRobotShape& shape, double x, double y)
    : bed_(bed),
      body_(dBodyCreate(world_.id())),
      wheels_{{{{}, Footprint::wheel(shape.wheel_radius_m, shape.wheel_width_m), {}},
               {{}, Footprint::wheel(shape.wheel_radius_m, shape.wheel_width_m), {}},
               {{}, Footprint::wheel(shape.wheel_radius_m, shape.wheel_width_m), {}},
               {{}, Footprint::wheel(shape.wheel_radius_m, shape.wheel_width_m), {}}}} {
  dMass all;
  dMassSetBoxTotal(&all, shape.chassis_kg, shape.chassis_m.x(), shape.chassis_m.y(),
                   shape.chassis_m.z());
  for (size_t i = 0; i < wheels_.size(); ++i) {
    Wheel& wheel = wheels_[i];
    wheel.place = {(i < 2 ? 0.5 : -0.5) * shape.wheelbase_m,
                   (i % 2 == 0 ? 0.5 : -0.5) * shape.track_m, -shape.chassis_above_axles_m};
    dMass one;
    constexpr int kAlongY = 2;
    dMassSetCylinderTotal(&one, shape.wheel_kg, kAlongY, shape.wheel_radius_m, shape.wheel_width_m);
    dMassTranslate(&one, wheel.place.x(), wheel.place.y(), wheel.place.z());
    dMassAdd(&all, &one);
  }
  mass_ = all.mass;
  const Eigen::Vector3d centre = to_eigen(all.c);
  dMassTranslate(&all, -centre.x(), -centre.y(), -centre.z());
  dBodySetMass(body_, &all);
  inverse_inertia_ = rotation_to_eigen(all.I).inverse();
  // The highest ground below a wheel decides where the level robot touches.
  double ground = -std::numeric_limits<double>::infinity();
  for (Wheel& wheel : wheels_) {
    wheel.place -= centre;
    ground = std::max(ground, bed.surface().at(x + wheel.place.x(), y + wheel.place.y()).height);
  }
  dBodySetPosition(body_, x, y, ground + shape.wheel_radius_m - wheels_[0].place.z());
}

void SoilRobot::step(double left_m_per_s, double right_m_per_s, double dt) {
  const Eigen::Vector3d origin = position();
  const Eigen::Matrix3d axes = rotation();
  const Eigen::Vector3d speed = velocity();
  PressingBody body;
  body.mass_kg = mass_;
  body.inverse_inertia = axes * inverse_inertia_ * axes.transpose();
  body.centre = origin;
  body.velocity = speed;
  body.omega = to_eigen(dBodyGetAngularVel(body_));
  std::array<FootprintContact, 4> contacts;
  for (size_t i = 0; i < wheels_.size(); ++i) {
    Wheel& wheel = wheels_[i];
    const Eigen::Vector3d arm = axes * wheel.place;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = axes;
    pose.translation() = origin + arm;
    wheel.footprint.set_pose(pose);
    FootprintContact& contact = contacts[i];
    contact.footprint = &wheel.footprint;
    contact.memory = &wheel.memory;
    contact.motion.surface_speed = i % 2 == 0 ? left_m_per_s : right_m_per_s;
    const double ground = (speed + body.omega.cross(arm)).dot(axes.col(0));
    contact.motion.slip = signed_slip(contact.motion.surface_speed, ground);
  }
  bed_.press(body, contacts, dt, memory_);
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();
  for (const FootprintContact& contact : contacts) {
    const Eigen::Vector3d arm = contact.footprint->pose().translation() - origin;
    force += contact.reaction.force;
    torque += arm.cross(contact.reaction.force) + contact.reaction.torque;
  }
  bed_.end_step();
  load_ = force.z();
  dBodyAddForce(body_, force.x(), force.y(), force.z());
  dBodyAddTorque(body_, torque.x(), torque.y(), torque.z());
  world_.step(dt);
}

Eigen::Vector3d SoilRobot::position() const {
  return to_eigen(dBodyGetPosition(body_));
}
Eigen::Vector3d SoilRobot::velocity() const {
  return to_eigen(dBodyGetLinearVel(body_));
}
Eigen::Matrix3d SoilRobot::rotation() const {
  return rotation_to_eigen(dBodyGetRotation(body_));
}

std::string surface_hash(const HeightField& surface) {
  ContentHash hash;
  for (int iy = 0; iy < surface.ny(); ++iy) {
    for (int ix = 0; ix < surface.nx(); ++ix) hash.add(surface.node(ix, iy));
  }
  return hash.hex();
}

}  // namespace screed
