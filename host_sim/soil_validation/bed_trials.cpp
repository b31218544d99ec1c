#include "host_sim/soil_validation/bed_trials.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "host_sim/core/constants.h"
#include "host_sim/core/content_hash.h"
#include "host_sim/core/elementary.h"
#include "host_sim/physics/soil/soil_bed.h"
#include "host_sim/soil_validation/check_range.h"

namespace screed {

namespace {

/// Chord of the flank from the pile's middle outwards along (dx, dy).
double flank_deg(const HeightField& surface, const ReposeTest& test, double dx, double dy) {
  const double step = 0.1 * test.cell_m;
  const double top = surface.at(test.centre_x_m, test.centre_y_m).height;
  double high = 0.0;
  double low = 0.0;
  const int steps = static_cast<int>(0.5 * test.size_m / step);
  for (int i = 0; i < steps; ++i) {
    const double distance = i * step;
    const double height =
        surface.at(test.centre_x_m + distance * dx, test.centre_y_m + distance * dy).height;
    if (height >= 0.75 * top) high = distance;
    if (height >= 0.25 * top) low = distance;
  }
  return portable::atan2(0.5 * top, low - high) / kDegree;
}

void tap(SoilBed& bed, const ReposeTest& test) {
  constexpr double kThickness_m = 0.02;
  Footprint plate = Footprint::disc(test.radius_m + 2.0 * test.cell_m, kThickness_m);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() << test.centre_x_m, test.centre_y_m,
      test.height_m + 0.5 * kThickness_m - test.tap_m;
  plate.set_pose(pose);
  FootprintMotion motion;
  motion.mass_kg = std::numeric_limits<double>::infinity();
  ContactMemory memory;
  bed.press(plate, motion, 1e-3, memory);
  bed.end_step();
}

}  // namespace

ReposeResult collapse(const ReposeTest& test) {
  check_range("repose", "cell", test.cell_m, 0.0005, 0.1);
  check_range("repose", "size", test.size_m, 0.1, 10.0);
  check_range("repose", "height", test.height_m, 1e-4, 10.0);
  check_range("repose", "radius", test.radius_m, test.cell_m, test.size_m);
  const int nodes = static_cast<int>(std::lround(test.size_m / test.cell_m)) + (test.wrap ? 0 : 1);
  const auto tower = [&](double x, double y) {
    double dx = x - test.centre_x_m;
    double dy = y - test.centre_y_m;
    if (test.wrap) {
      dx = std::remainder(dx, nodes * test.cell_m);
      dy = std::remainder(dy, nodes * test.cell_m);
    }
    return portable::hypot(dx, dy) <= test.radius_m ? test.height_m : 0.0;
  };
  SoilBed bed(HeightField::from_function(nodes, nodes, test.cell_m, test.wrap, tower), test.soil);
  const int64_t before = bed.surface().height_sum();
  if (test.tap_m > 0.0) tap(bed, test);
  const int64_t moves = bed.relax_slopes();
  return {moves,
          before - bed.surface().height_sum() - bed.balance().compacted - bed.balance().in_transit,
          repose_excess_units(bed.surface(), test.soil.repose_deg),
          flank_deg(bed.surface(), test, 1.0, 0.0),
          flank_deg(bed.surface(), test, std::numbers::sqrt2 / 2.0, std::numbers::sqrt2 / 2.0),
          bed.surface()};
}

double repose_excess_units(const HeightField& surface, double repose_deg) {
  const double straight = portable::tan(repose_deg * kDegree) * surface.spacing_m() / kHeightUnit_m;
  double worst = -std::numeric_limits<double>::infinity();
  for (int iy = 0; iy < surface.ny(); ++iy) {
    for (int ix = 0; ix < surface.nx(); ++ix) {
      for (const auto& [dx, dy] :
           {std::pair(1, 0), std::pair(0, 1), std::pair(1, 1), std::pair(-1, 1)}) {
        int x = ix + dx;
        int y = iy + dy;
        if (surface.wrap()) {
          x = (x + surface.nx()) % surface.nx();
          y %= surface.ny();
        } else if (x < 0 || x >= surface.nx() || y >= surface.ny()) {
          continue;
        }
        const double limit = dx != 0 && dy != 0 ? straight * std::numbers::sqrt2 : straight;
        const double difference =
            std::abs(static_cast<double>(surface.node(ix, iy)) - surface.node(x, y));
        worst = std::max(worst, difference - limit);
      }
    }
  }
  return worst;
}

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
