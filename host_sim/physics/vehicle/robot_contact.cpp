// Points of one robot in solids of another.
#include "host_sim/physics/vehicle/robot_contact.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host_sim/core/elementary.h"
#include "host_sim/physics/terrain/solid_contact.h"

namespace screed {
namespace {

// Of two robots, by their reduced mass, critically damped: a push of 20 N presses two of 1.4 kg
// 0.7 mm together, an impact at 0.5 m/s some 0.9 mm.
constexpr double kRobotFrequency_rad_per_s = 200.0;
// Robots that are put into one another part without a bang.
constexpr double kDeepest_m = 0.02;
constexpr double kPi = std::numbers::pi;

/// From the rear axle to the front one, unit length.
Eigen::Vector3d forward_of(const RunningGearGeometry& gear) {
  const Eigen::Vector3d run = gear.front - gear.rear;
  const double length = run.norm();
  return length > 0.0 ? Eigen::Vector3d(run / length) : Eigen::Vector3d::UnitX();
}

}  // namespace

/// One of the two bodies at a touch: how it moves there, and how it answers.
struct RobotContact::Side {
  const RobotBody& body;
  Eigen::Vector3d arm;  // from its centre of mass
  size_t drive;
  Eigen::Vector3d along;

  Side(const RobotBody& of, const Eigen::Vector3d& at, size_t by, const Eigen::Vector3d& moving)
      : body(of), arm(at - of.motion.centre), drive(by), along(moving) {}

  bool driven() const { return drive < body.drives.size(); }
  Eigen::Vector3d velocity() const { return body.motion.velocity + body.motion.omega.cross(arm); }
  Eigen::Vector3d surface_velocity() const {
    if (!driven()) return velocity();
    return velocity() + body.drives[drive].omega_rad_per_s * along;
  }
  double mobility(const Eigen::Vector3d& direction) const {
    const Eigen::Vector3d lever = arm.cross(direction);
    return 1.0 / body.motion.mass_kg + lever.dot(body.motion.inverse_inertia * lever);
  }
  double surface_mobility(const Eigen::Vector3d& direction) const {
    if (!driven()) return mobility(direction);
    const double lever = along.dot(direction);
    return mobility(direction) + lever * lever * body.drives[drive].inverse_inertia_per_kg_m2;
  }
  /// `rub` is the part of the impulse that acts along the surface.
  void take(const Eigen::Vector3d& impulse, const Eigen::Vector3d& rub, double dt) const {
    body.wrench.add(impulse / dt, arm);
    if (driven()) body.drives[drive].torque_n_m += along.dot(rub) / dt;
  }
};

std::vector<BodyPoint> middle_of(const RunningGearGeometry& gear, size_t drive) {
  constexpr double kSpacing_m = 0.0125;
  const Eigen::Vector3d forward = forward_of(gear);
  const Eigen::Vector3d up = forward.cross(Eigen::Vector3d::UnitY());
  const double length = (gear.front - gear.rear).norm();
  const int arc = std::max(8, static_cast<int>(std::lround(kPi * gear.radius / kSpacing_m)));
  const int run = static_cast<int>(std::lround(length / kSpacing_m));
  std::vector<BodyPoint> points;
  for (int i = 0; i < 2 * arc; ++i) {  // from the top, forwards and down
    const double angle = (i + 0.5) * kPi / arc;
    const auto [sine, cosine] = portable::sine_cosine(angle);
    const Eigen::Vector3d out = sine * forward + cosine * up;
    const Eigen::Vector3d along = cosine * forward - sine * up;
    const Eigen::Vector3d& axle = i < arc ? gear.front : gear.rear;
    points.push_back({axle + gear.radius * out, along, drive, gear.radius});
  }
  for (int i = 0; i < run; ++i) {
    const Eigen::Vector3d at = gear.rear + (i + 0.5) / run * (gear.front - gear.rear);
    points.push_back({at + gear.radius * up, forward, drive, gear.radius});
    points.push_back({at - gear.radius * up, -forward, drive, gear.radius});
  }
  return points;
}

SolidPart solid_of(const RunningGearGeometry& gear, size_t drive) {
  const double length = (gear.front - gear.rear).norm();
  const Eigen::Vector3d forward = forward_of(gear);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() << forward, Eigen::Vector3d::UnitY(), forward.cross(Eigen::Vector3d::UnitY());
  pose.translation() = 0.5 * (gear.front + gear.rear);
  return {Footprint::track(0.5 * length, gear.radius, gear.width), pose, drive, gear.radius};
}

void RobotContact::add_touches(const RobotBody& pointed, const RobotBody& solid) {
  // In the frame of the body with the solids.
  const Eigen::Matrix3d turn = solid.rotation.transpose() * pointed.rotation;
  const Eigen::Vector3d from =
      solid.rotation.transpose() * (pointed.motion.centre - solid.motion.centre);
  for (const SolidPart& part : solid.solids) {
    // Most points are far from most parts: by spheres round them.
    const Eigen::Vector3d centre = part.pose.translation();
    const double reach = part.shape.half().norm() + part.shape.radius() + notice_m_;
    const double apart = pointed.reach_m + reach;
    if ((from - centre).squaredNorm() > apart * apart) continue;
    const Eigen::Isometry3d to_part = part.pose.inverse();
    const Eigen::Matrix3d axes = solid.rotation * part.pose.linear();
    for (const BodyPoint& point : pointed.points) {
      const Eigen::Vector3d at = from + turn * point.at;
      if ((at - centre).squaredNorm() > reach * reach) continue;
      const SolidContact near = nearest_on(part.shape, to_part * at);
      if (near.distance < notice_m_) gap_m_ = std::min(gap_m_, near.distance);
      if (near.distance >= 0.0) continue;
      touches_.push_back({&pointed, &solid, -near.distance, axes * near.normal,
                          solid.motion.centre + solid.rotation * at, point.drive,
                          pointed.rotation * (point.radius * point.along), part.drive,
                          axes * (part.radius_m * near.belt)});
    }
  }
}

void RobotContact::find_touches(const RobotBody& one, const RobotBody& other) {
  touches_.clear();
  add_touches(one, other);
  add_touches(other, one);
  total_depth_ = 0.0;
  for (const Touch& touch : touches_) total_depth_ += touch.depth;
}

void RobotContact::push(const Touch& touch, double dt) const {
  const Side point(*touch.pointed, touch.at, touch.point_drive, touch.point_along);
  const Side solid(*touch.solid, touch.at, touch.solid_drive, touch.solid_along);
  const double share = touch.depth / total_depth_;
  const double reduced_kg = 1.0 / (1.0 / touch.pointed->robot_kg + 1.0 / touch.solid->robot_kg);
  const double stiffness = reduced_kg * kRobotFrequency_rad_per_s * kRobotFrequency_rad_per_s;
  const double damping = 2.0 * reduced_kg * kRobotFrequency_rad_per_s;
  const double gain = dt * (damping + dt * stiffness);

  const double speed = touch.normal.dot(point.velocity() - solid.velocity());
  const double mobility = point.mobility(touch.normal) + solid.mobility(touch.normal);
  const double wanted = dt * stiffness * std::min(touch.depth, kDeepest_m) - gain * speed;
  const double normal = share * std::max(0.0, wanted) / (1.0 + gain * mobility);
  if (normal == 0.0) return;

  Eigen::Vector3d sliding = point.surface_velocity() - solid.surface_velocity();
  sliding -= sliding.dot(touch.normal) * touch.normal;
  Eigen::Vector3d friction = Eigen::Vector3d::Zero();
  const double sliding_speed = sliding.norm();
  if (sliding_speed > 0.0) {
    const Eigen::Vector3d direction = sliding / sliding_speed;
    const double stops = share * sliding_speed /
                         (point.surface_mobility(direction) + solid.surface_mobility(direction));
    friction = -std::min(stops, friction_ * normal) * direction;
  }
  const Eigen::Vector3d impulse = normal * touch.normal + friction;
  point.take(impulse, friction, dt);
  solid.take(-impulse, -friction, dt);
}

void RobotContact::press(const RobotBody& one, const RobotBody& other, double dt) {
  find_touches(one, other);
  for (const Touch& touch : touches_) push(touch, dt);
}

double RobotContact::depth(const RobotBody& one, const RobotBody& other) {
  find_touches(one, other);
  double deepest = 0.0;
  for (const Touch& touch : touches_) deepest = std::max(deepest, touch.depth);
  return deepest;
}

}  // namespace screed
