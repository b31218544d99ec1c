// Contact points along the contour of a belt or a wheel.
#include "host_sim/physics/vehicle/running_gear.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host_sim/core/elementary.h"

namespace screed {

namespace {

constexpr double kSpacing_m = 0.0125;  // of contact points along a belt
// Of those round a wheel, in radii: the ground touches a few millimetres of it.
constexpr double kWheelSpacing = 0.1;
constexpr double kSinkIn_m = 0.0004;  // under the unit's own load on level ground
constexpr double kDampingRatio = 0.7;

}  // namespace

void RunningGear::add_point(const Eigen::Vector3d& at, const Eigen::Vector3d& out,
                            const Eigen::Vector3d& along) {
  points_.push_back(at);
  outwards_.push_back(out);
  along_.push_back(along);
}

RunningGear::RunningGear(const RunningGearGeometry& geometry, double friction, const GearLoad& load)
    : geometry_(geometry),
      centre_(0.5 * (geometry.front + geometry.rear)),
      footprint_(Footprint::track(0.5 * (geometry.front - geometry.rear).norm(), geometry.radius,
                                  geometry.width)),
      side_footprint_(
          Footprint::box({(geometry.front - geometry.rear).norm() + 2.0 * geometry.radius,
                          geometry.width, 2.0 * geometry.radius})) {
  const double radius = geometry.radius;
  const Eigen::Vector3d run = geometry.front - geometry.rear;
  const double length = run.norm();
  const Eigen::Vector3d forward =
      length > 0.0 ? Eigen::Vector3d(run / length) : Eigen::Vector3d::UnitX();
  const Eigen::Vector3d up = forward.cross(Eigen::Vector3d::UnitY());  // contour plane: forward, up
  axes_ << forward, Eigen::Vector3d::UnitY(), up;
  const double spacing = length > 0.0 ? kSpacing_m : kWheelSpacing * radius;
  const int half_points =
      std::max(8, static_cast<int>(std::lround(std::numbers::pi * radius / spacing)));
  const int run_points =
      length > 0.0 ? std::max(1, static_cast<int>(std::lround(length / kSpacing_m))) : 0;
  spacing_ = std::numbers::pi * radius / half_points;

  // Driving forward the material goes: down round the front wheel, back along the bottom, up round
  // the rear wheel, forward on top.
  for (int row = 0; row < rows_; ++row) {
    const Eigen::Vector3d side =
        Eigen::Vector3d::UnitY() * geometry.width * (row == 0 ? 0.5 : -0.5);
    const auto arc = [&](const Eigen::Vector3d& axle, double start_rad) {
      for (int i = 0; i < half_points; ++i) {
        const double angle =
            start_rad + (i + 0.5) * std::numbers::pi / half_points;  // from top, forwards
        const auto [sine, cosine] = portable::sine_cosine(angle);
        const Eigen::Vector3d out = sine * forward + cosine * up;
        const Eigen::Vector3d along = cosine * forward - sine * up;
        add_point(axle + side + radius * out, out, along);
      }
    };
    arc(geometry.front, 0.0);
    for (int i = 0; i < run_points; ++i) {
      const Eigen::Vector3d at = geometry.front - (i + 0.5) / run_points * run;
      add_point(at + side - radius * up, -up, -forward);
    }
    arc(geometry.rear, std::numbers::pi);
    for (int i = 0; i < run_points; ++i) {
      const Eigen::Vector3d at = geometry.rear + (i + 0.5) / run_points * run;
      add_point(at + side + radius * up, up, forward);
    }
  }
  bristles_.assign(points_.size(), Eigen::Vector3d::Zero());
  carried_ = bristles_;
  bent_.assign(points_.size(), 0);

  // On level ground the belt's lower run carries the load. A wheel that has sunk in by d touches
  // over 2 sqrt(2 R d), and the mean depth there is 2/3 d.
  const double patch = 2.0 * std::sqrt(2.0 * radius * kSinkIn_m);
  const double carrying =
      rows_ * (run_points > 0 ? static_cast<double>(run_points) : 2.0 / 3.0 * patch / spacing_);
  law_.friction = friction;
  law_.stiffness = load.weight_n / (kSinkIn_m * carrying);
  law_.damping = 2.0 * kDampingRatio * std::sqrt(law_.stiffness * load.mass_kg / carrying);
}

void RunningGear::reset_contacts() {
  memory_ = {};
  for (size_t i = 0; i < points_.size(); ++i) reset_contacts(i);
}

void RunningGear::reset_contacts(size_t point) {
  if (bent_[point] == 0) return;
  bristles_[point].setZero();
  carried_[point].setZero();
  bent_[point] = 0;
}

// The brush model's transport: what a point's material has been bent so far comes with it from the
// neighbour it passed before. First-order upwind; a belt at 0.25 m/s moves 2 % of the spacing in a
// step of 1 ms.
void RunningGear::carry_bristles(double speed, double dt) {
  const double share = std::min(1.0, std::abs(speed) * dt / spacing_);
  if (share == 0.0) return;
  const size_t row_points = points_.size() / static_cast<size_t>(rows_);
  const bool forward = speed > 0.0;
  carried_.swap(bristles_);
  for (size_t row = 0; row < static_cast<size_t>(rows_); ++row) {
    const size_t first = row * row_points;
    const size_t last = first + row_points - 1;
    size_t before = forward ? last : first;
    bool before_was_bent = bent_[before] != 0;
    for (size_t i = 0; i < row_points; ++i) {
      const size_t here = forward ? first + i : last - i;
      const bool was_bent = bent_[here] != 0;
      if (was_bent || before_was_bent) {  // else both are zero, in both buffers
        bristles_[here] = carried_[here] + share * (carried_[before] - carried_[here]);
        bent_[here] = 1;
      }
      before = here;
      before_was_bent = was_bent;
    }
  }
}

// Flattened: otherwise each of a robot's 200 points makes a handful of calls, a tenth of a rigid
// step.
[[gnu::flatten]] double RunningGear::stand_on(const HeightField& hard, const CarrierMotion& carrier,
                                              double speed, double dt, Wrench& wrench) {
  carry_bristles(speed, dt);
  touches_.clear();
  TerrainContact contact;
  // A height field has no overhangs: a point on the upper side of the contour has a lower one right
  // below it, which touches first.
  const Eigen::RowVector3d upwards = carrier.rotation.row(2);
  for (size_t i = 0; i < points_.size(); ++i) {
    if (upwards.dot(outwards_[i]) > kUpperSide) {
      reset_contacts(i);
      continue;
    }
    const Eigen::Vector3d arm = carrier.rotation * points_[i];
    if (!find_contact(hard, carrier.origin + arm, contact)) {
      reset_contacts(i);
      continue;
    }
    bent_[i] = 1;
    touches_.add(i, points_[i], arm, contact);
  }
  const ContactLaw law = touches_.softened(law_, carrier, dt);
  double along_surface = 0.0;
  for (const GroundTouches::Touch& touch : touches_.touches()) {
    const Eigen::Vector3d along = carrier.rotation * along_[touch.point];
    const Eigen::Vector3d velocity = carrier.velocity + carrier.omega.cross(touch.arm);
    const Eigen::Vector3d force = contact_force(
        law, touch.contact, velocity, velocity + speed * along, dt, bristles_[touch.point]);
    wrench.add(force, touch.arm);
    along_surface += force.dot(along);
    normal_load_ += force.z();
  }
  return along_surface;
}

FootprintContact RunningGear::make_footprint_contact(FootprintShape shape,
                                                     const CarrierMotion& carrier, double speed) {
  FootprintContact contact;
  contact.arm = carrier.rotation * centre_;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = carrier.rotation * axes_;
  pose.translation() = carrier.origin + contact.arm;
  // A solid is touched from any side; the lower surface of a contour on its side is a plane.
  const bool on_its_side =
      shape == FootprintShape::kLowerSurface && std::abs(pose.linear()(2, 1)) > kOnItsSide;
  Footprint& footprint = on_its_side ? side_footprint_ : footprint_;
  footprint.set_pose(pose);
  contact.footprint = &footprint;
  contact.memory = &memory_;

  FootprintMotion& motion = contact.motion;
  motion.velocity = carrier.velocity + carrier.omega.cross(contact.arm);
  motion.omega = carrier.omega;
  motion.surface_speed = on_its_side ? 0.0 : speed;
  motion.friction = law_.friction;
  motion.lug_height_m = geometry_.lug_height_m;
  const double ground_speed = motion.velocity.dot(pose.linear().col(0));
  motion.slip = signed_slip(speed, ground_speed);
  return contact;
}

double RunningGear::apply_contact(const HeightField* hard, const FootprintContact* pressed,
                                  const CarrierMotion& carrier, double speed, double dt,
                                  Wrench& wrench) {
  double along_surface = 0.0;
  normal_load_ = 0.0;
  if (hard != nullptr) along_surface = stand_on(*hard, carrier, speed, dt, wrench);
  if (pressed != nullptr) {
    wrench.add(*pressed);
    along_surface += pressed->reaction.along_surface;
    normal_load_ += pressed->reaction.normal_load;
    sinkage_ = pressed->reaction.sinkage;
  }
  return along_surface;
}

}  // namespace screed
