// Points on walls, solved together.
#include "host_sim/physics/vehicle/wall_contact.h"

#include <algorithm>
#include <cmath>

namespace screed {
namespace {

// Of the whole robot on one point, critically damped: at 1 m/s it goes 1.2 mm into a wall.
constexpr double kWallFrequency_rad_per_s = 300.0;
constexpr double kSliding = 1.0 - 1e-9;  // share of Coulomb's limit
constexpr int kMaxSweeps = 60;
constexpr double kTolerance_m_per_s = 1e-7;  // of the whole robot, by one impulse in a sweep

}  // namespace

/// Velocities with the impulses so far.
struct WallContact::Motion {
  const PressingBody& body;
  Eigen::Vector3d velocity;
  Eigen::Vector3d omega;
  std::vector<SurfaceDrive>& drives;
  double dt;

  /// How an impulse at `arm` along a unit vector changes the body's velocity there along it.
  double mobility(const Eigen::Vector3d& arm, const Eigen::Vector3d& direction) const {
    const Eigen::Vector3d lever = arm.cross(direction);
    return 1.0 / body.mass_kg + lever.dot(body.inverse_inertia * lever);
  }
  Eigen::Vector3d at(const Touch& touch) const { return velocity + omega.cross(touch.arm); }
  /// Of the surface over the wall, along the wall.
  Eigen::Vector3d sliding(const Touch& touch, const Point& point) const {
    Eigen::Vector3d surface = at(touch);
    if (point.drive != kNoDrive)
      surface += drives[point.drive].omega_rad_per_s * point.radius * touch.along;
    return surface - surface.dot(touch.normal) * touch.normal;
  }
  void push(const Touch& touch, const Eigen::Vector3d& impulse) {
    velocity += impulse / body.mass_kg;
    omega += body.inverse_inertia * touch.arm.cross(impulse);
  }
  /// Along the wall: the surface's drive has it too.
  void rub(const Touch& touch, const Point& point, const Eigen::Vector3d& impulse) {
    push(touch, impulse);
    if (point.drive == kNoDrive) return;
    SurfaceDrive& drive = drives[point.drive];
    const double twist = point.radius * touch.along.dot(impulse);
    drive.omega_rad_per_s += drive.inverse_inertia_per_kg_m2 * twist;
    drive.torque_n_m += twist / dt;
  }
};

void WallContact::add_point(const Eigen::Vector3d& at) {
  points_.push_back({at, Eigen::Vector3d::Zero(), kNoDrive, 0.0});
}

void WallContact::add_point(const Eigen::Vector3d& at, const Eigen::Vector3d& along, size_t drive,
                            double radius_m) {
  points_.push_back({at, along, drive, radius_m});
}

void WallContact::close(double friction, double robot_kg) {
  friction_ = friction;
  stiffness_ = robot_kg * kWallFrequency_rad_per_s * kWallFrequency_rad_per_s;
  damping_ = 2.0 * robot_kg * kWallFrequency_rad_per_s;
  tolerance_ = robot_kg * kTolerance_m_per_s;
  reach_ = 0.0;
  for (const Point& point : points_) reach_ = std::max(reach_, point.at.norm());
  touched_ = true;
  reset_contacts();
}

void WallContact::reset_contacts() {
  if (!touched_) return;
  for (auto& of_axis : memories_) of_axis.assign(points_.size(), {});
  touches_.clear();
  touched_ = false;
}

bool WallContact::within_reach(const BedBounds& bed, const Eigen::Vector3d& centre) const {
  return std::min(0.5 * bed.width_m - std::abs(centre.x()),
                  0.5 * bed.depth_m - std::abs(centre.y())) < reach_;
}

void WallContact::find_touches(const BedBounds& bed, const PressingBody& body,
                               const Eigen::Matrix3d& rotation) {
  const Eigen::Vector2d half(0.5 * bed.width_m, 0.5 * bed.depth_m);
  touches_.clear();
  for (size_t i = 0; i < points_.size(); ++i) {
    const Eigen::Vector3d arm = rotation * points_[i].at;
    for (const Eigen::Index axis : {0, 1}) {
      const auto number = static_cast<size_t>(axis);
      const double coordinate = body.centre[axis] + arm[axis];
      const double depth = std::abs(coordinate) - half[axis];
      if (!(depth > 0.0)) {
        memories_[number][i] = {};
        continue;
      }
      const Eigen::Vector3d normal = -std::copysign(1.0, coordinate) * Eigen::Vector3d::Unit(axis);
      touches_.push_back(
          {i, number, normal, depth, arm, rotation * points_[i].along, Eigen::Vector3d::Zero()});
    }
  }
}

/// Brings one touch to its law, all others as they are. Returns the impulse's change, N s.
double WallContact::solve(const Touch& touch, const Memory& memory, double dt, Motion& motion,
                          Eigen::Vector3d& impulse) const {
  const Point& point = points_[touch.point];
  const double gain = dt * (damping_ + dt * stiffness_);  // N s per m/s

  const Eigen::Vector3d before = impulse;
  double normal_impulse = impulse.dot(touch.normal);
  const double speed = touch.normal.dot(motion.at(touch));
  const double wanted = dt * stiffness_ * touch.depth - gain * speed;
  const double softened = 1.0 + gain * motion.mobility(touch.arm, touch.normal);
  const double pushed = std::max(0.0, normal_impulse + (wanted - normal_impulse) / softened);
  const Eigen::Vector3d more = (pushed - normal_impulse) * touch.normal;
  motion.push(touch, more);
  impulse += more;
  normal_impulse = pushed;

  // Both directions along the wall with the larger mobility of the two.
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d level = up.cross(touch.normal);
  const auto mobility_along = [&](const Eigen::Vector3d& direction) {
    double mobility = motion.mobility(touch.arm, direction);
    if (point.drive != kNoDrive) {
      const double lever = point.radius * touch.along.dot(direction);
      mobility += lever * lever * motion.drives[point.drive].inverse_inertia_per_kg_m2;
    }
    return mobility;
  };
  // A sum bounds the larger eigenvalue, whatever couples the two directions.
  const double mobility = mobility_along(up) + mobility_along(level);
  const Eigen::Vector3d friction_before = impulse - normal_impulse * touch.normal;
  const Eigen::Vector3d held =
      -dt * stiffness_ * memory.bristle - gain * motion.sliding(touch, point);
  Eigen::Vector3d friction = friction_before + (held - friction_before) / (1.0 + gain * mobility);
  const double limit = friction_ * normal_impulse;
  const double size = friction.norm();
  if (size > limit) friction *= limit / size;
  motion.rub(touch, point, friction - friction_before);
  impulse = normal_impulse * touch.normal + friction;
  return (impulse - before).norm();
}

void WallContact::press(const BedBounds& bed, const PressingBody& body,
                        const Eigen::Matrix3d& rotation, double dt,
                        std::vector<SurfaceDrive>& drives, Wrench& wrench) {
  find_touches(bed, body, rotation);
  if (touches_.empty()) return;
  touched_ = true;

  Motion motion{body, body.velocity, body.omega, drives, dt};
  for (const Touch& touch : touches_) {
    // As far as it has really slid since the last step, whatever else pushed.
    Memory& memory = memory_of(touch);
    if (memory.touching) memory.bristle += dt * motion.sliding(touch, points_[touch.point]);
    memory.touching = true;
  }
  // The last step's impulses are near the solution.
  for (Touch& touch : touches_) {
    touch.impulse = memory_of(touch).impulse;
    motion.push(touch, touch.impulse.dot(touch.normal) * touch.normal);
    motion.rub(touch, points_[touch.point], touch.friction());
  }
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    double change = 0.0;
    for (Touch& touch : touches_) {
      change = std::max(change, solve(touch, memory_of(touch), dt, motion, touch.impulse));
    }
    if (change < tolerance_) break;
  }
  for (const Touch& touch : touches_) {
    wrench.add(touch.impulse / dt, touch.arm);
    Memory& memory = memory_of(touch);
    memory.impulse = touch.impulse;
    // One that slides is bent as far as Coulomb lets it. One that holds may be bent further: it
    // makes up for what the damper takes for sliding, a step of the forces that are not in here.
    const Eigen::Vector3d friction = touch.friction();
    if (friction.norm() >= kSliding * friction_ * touch.impulse.dot(touch.normal))
      memory.bristle = friction / (-dt * stiffness_);
  }
}

}  // namespace screed
