// Places that move with the material.
//
// Place i lies at along = i spacing - travelled. Those between the contact's rear and front shear;
// one that came into contact within the step has done so for a part of it. Between the front and
// the first place behind it the share falls to zero, as it began there.
#include "host_sim/physics/terrain/shear_field.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "host_sim/core/elementary.h"
#include "host_sim/physics/kernels/triple.h"

namespace screed {

namespace {

constexpr double kSpacing_m = 0.0025;  // at most, a quarter of the least usual K
// Along a contour: of one with arcs alone a small part touches.
constexpr double kMinPlaces = 48.0;
constexpr double kMinPlacesOnAWheel = 192.0;

}  // namespace

double RunContour::length_m() const {
  return 2.0 * half_m + std::numbers::pi * radius_m;
}

double RunContour::along(double ahead_m) const {
  const double beyond = std::abs(ahead_m) - half_m;
  if (beyond <= 0.0 || radius_m <= 0.0) return ahead_m;
  const double arc = radius_m * portable::asin(std::min(1.0, beyond / radius_m));
  return std::copysign(half_m + arc, ahead_m);
}

void ShearField::lay_out(const RunContour& contour) {
  const double length = contour.length_m();
  const double min_places = contour.half_m > 0.0 ? kMinPlaces : kMinPlacesOnAWheel;
  spacing_ = std::min(kSpacing_m, length / min_places);
  // All of a contour twice over: they are moved back seldom.
  room_ = whole_blocks(2 * static_cast<size_t>(length / spacing_) + 4 * screed::kLanes);
  arrays_.assign(static_cast<size_t>(kLanes) * kProperties * room_, 0.0);
  lane_offset_ = 0.5 * contour.half_width_m;
}

/// The arrays follow the places in contact; kernels may touch up to a block beyond the last.
void ShearField::make_room(int64_t first, int64_t last) {
  const auto room = static_cast<int64_t>(room_);
  constexpr auto kBlock = static_cast<int64_t>(screed::kLanes);
  if (first >= base_ && last + kBlock <= base_ + room) return;
  const int64_t base = first - (room - (last - first + 1)) / 2;
  const int64_t kept_first = std::max({first_, base_, base});
  const int64_t kept_end = std::min({last_ + 1, base_ + room, base + room});
  for (int row = 0; row < kLanes * kProperties; ++row) {
    double* begin = arrays_.data() + static_cast<size_t>(row) * room_;
    if (kept_first < kept_end) {
      std::memmove(begin + (kept_first - base), begin + (kept_first - base_),
                   static_cast<size_t>(kept_end - kept_first) * sizeof(double));
    }
  }
  base_ = base;
}

ShearPlaces ShearField::places_from(int64_t index) const {
  ShearPlaces places{};
  for (int lane = 0; lane < kLanes; ++lane) {
    const auto at = [&](Property property) { return array(lane, property, index); };
    places.side[lane] = {at(kAlong),       at(kAcross),      at(kYield),
                         at(kAheadAlong),  at(kAheadAcross), at(kValueAlong),
                         at(kValueAcross), at(kSliding),     at(kFlowing)};
  }
  return places;
}

/// Soil that has been sheared stays on the ground while the contour moves over it; beside it the
/// contour meets fresh soil. False: none is left below.
bool ShearField::leave_behind(const RunContour& contour, const RunMotion& motion, double dt) {
  const double end = 0.5 * contour.length_m();
  const double reach = contour.half_m + contour.radius_m;
  const auto moved = [&](double edge) -> Eigen::Vector2d {  // ahead, aside
    const Eigen::Vector3d arm(std::clamp(edge, -reach, reach), 0.0, -contour.below_m);
    const Eigen::Vector3d velocity = motion.velocity + motion.omega.cross(arm);
    return {velocity.x() * dt, std::abs(velocity.y()) * dt};
  };
  const Eigen::Vector2d at_front = moved(front_);
  const Eigen::Vector2d at_rear = moved(rear_);
  front_ = std::min(front_ - at_front.x() - at_front.y(), end);
  rear_ = std::max(rear_ - at_rear.x() + at_rear.y(), -end);
  return rear_ < front_;
}

void ShearField::hover(const RunContour& contour, const RunMotion& motion, double dt) {
  if (!touching_) return;
  travelled_ += motion.surface_speed * dt;
  touching_ = leave_behind(contour, motion, dt);
  first_ = static_cast<int64_t>(std::ceil((rear_ + travelled_) / spacing_));
  last_ = static_cast<int64_t>(std::floor((front_ + travelled_) / spacing_));
  if (last_ < first_) touching_ = false;
}

void ShearField::advance(const RunContour& contour, const RunMotion& motion, double rear,
                         double front, double shear_modulus_m, double damping_s, double dt,
                         const Kernels& kernels) {
  if (arrays_.empty()) lay_out(contour);
  const double moved = motion.surface_speed * dt;
  travelled_ += moved;
  const double rear_before = rear_ - moved;  // where the material of that edge is now
  const double front_before = front_ - moved;
  if (touching_ && leave_behind(contour, motion, dt)) {
    rear = std::min(rear, rear_);
    front = std::max(front, front_);
  }
  from_front_ = motion.surface_speed >= 0.0;
  auto first = static_cast<int64_t>(std::ceil((rear + travelled_) / spacing_));
  auto last = static_cast<int64_t>(std::floor((front + travelled_) / spacing_));
  if (last < first) first = last = std::llround((0.5 * (rear + front) + travelled_) / spacing_);
  make_room(first, last);
  ShearStep step{};
  step.first_along = static_cast<double>(first) * spacing_ - travelled_;
  step.spacing = spacing_;
  step.count = static_cast<size_t>(last - first + 1);
  step.old_first = static_cast<double>(first_ - first);
  step.old_last = static_cast<double>(last_ - first);
  step.touching = touching_;
  step.rear = rear;
  step.front = front;
  step.rear_before = rear_before;
  step.front_before = front_before;
  step.half = contour.half_m;
  step.radius = contour.radius_m;
  step.below = contour.below_m;
  step.left = lane_offset_;
  step.velocity = triple(motion.velocity);
  step.omega = triple(motion.omega);
  step.surface_speed = motion.surface_speed;
  step.per_k = dt / shear_modulus_m;
  step.damping = damping_s / (ShearState::kElastic * shear_modulus_m);
  step.elastic = ShearState::kElastic;
  step.sideways_only = motion.sideways_only;
  step.level = motion.level;
  kernels.advance_shear(step, places_from(first));
  touching_ = true;
  rear_ = rear;
  front_ = front;
  first_ = first;
  last_ = last;
}

ShearView ShearField::view() const {
  ShearView view;
  view.touching = touching_;
  if (!touching_) return view;
  view.places = places_from(first_);
  view.count = static_cast<double>(last_ - first_ + 1);
  view.first_along = static_cast<double>(first_) * spacing_ - travelled_;
  view.last_along = static_cast<double>(last_) * spacing_ - travelled_;
  view.per_spacing = 1.0 / spacing_;
  view.rear = rear_;
  view.front = front_;
  view.from_front = from_front_;
  view.per_offset = 0.5 / lane_offset_;
  return view;
}

ShearField::Value ShearField::at(double along, double across) const {
  Value value;
  const Kernels& kernels = best_kernels();
  kernels.look_up_shear(view(), along, across, value.along, value.across, value.sliding);
  return value;
}

}  // namespace screed
