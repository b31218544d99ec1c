// Places in a ring, moved with the material.
//
// Place i lies at along = i spacing - travelled. Those between the contact's rear and front shear;
// one that came into contact within the step has done so for a part of it. Between the front and
// the first place behind it the share falls to zero, as it began there.
#include "host_sim/physics/terrain/shear_field.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

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
  const double arc = radius_m * std::asin(std::min(1.0, beyond / radius_m));
  return std::copysign(half_m + arc, ahead_m);
}

void ShearField::advance(const RunContour& contour, const RunMotion& motion, double rear,
                         double front, double shear_modulus_m, double damping_s, double dt) {
  if (places_.empty()) {
    const double length = contour.length_m();
    const double min_places = contour.half_m > 0.0 ? kMinPlaces : kMinPlacesOnAWheel;
    spacing_ = std::min(kSpacing_m, length / min_places);
    ring_ = std::bit_ceil(static_cast<size_t>(length / spacing_) + 4);
    places_.resize(kLanes * ring_);
    lane_offset_ = 0.5 * contour.half_width_m;
  }
  const double moved = motion.surface_speed * dt;
  const double front_before = front_ - moved;  // where the material of that edge is now
  const double rear_before = rear_ - moved;
  travelled_ += moved;
  from_front_ = motion.surface_speed >= 0.0;
  auto first = static_cast<int64_t>(std::ceil((rear + travelled_) / spacing_));
  auto last = static_cast<int64_t>(std::floor((front + travelled_) / spacing_));
  if (last < first) first = last = std::llround((0.5 * (rear + front) + travelled_) / spacing_);
  const double per_k = dt / shear_modulus_m;
  const double damping = damping_s / (ShearState::kElastic * shear_modulus_m);
  const double per_radius = contour.radius_m > 0.0 ? 1.0 / contour.radius_m : 0.0;

  for (int64_t i = first; i <= last; ++i) {
    const double along = static_cast<double>(i) * spacing_ - travelled_;
    double part = 1.0;  // of the step in contact
    const bool is_new = !touching_ || i < first_ || i > last_;
    if (is_new && touching_ && along > front_before && front > front_before) {
      part = std::min(1.0, (front - along) / (front - front_before));
    } else if (is_new && touching_ && along < rear_before && rear < rear_before) {
      part = std::min(1.0, (along - rear) / (rear_before - rear));
    }
    // Of the contour at this place: how far ahead and below, and its direction.
    double ahead = along;
    double down = contour.below_m;
    double cos = 1.0;
    double sin = 0.0;
    if (const double beyond = std::abs(along) - contour.half_m;
        beyond > 0.0 && contour.radius_m > 0.0) {
      const double angle = beyond * per_radius;
      cos = std::cos(angle);
      sin = std::copysign(std::sin(angle), along);
      ahead = std::copysign(contour.half_m, along) + contour.radius_m * sin;
      down = contour.below_m - contour.radius_m * (1.0 - cos);
    }
    for (int lane = 0; lane < kLanes; ++lane) {
      const double left = lane == 0 ? lane_offset_ : -lane_offset_;
      const Eigen::Vector3d arm(ahead, left, -down);
      const Eigen::Vector3d velocity = motion.velocity + motion.omega.cross(arm);
      double slide_along = velocity.x() * cos + velocity.z() * sin - motion.surface_speed;
      if (motion.level) slide_along = velocity.x() - motion.surface_speed * cos;
      if (motion.sideways_only) slide_along = 0.0;
      const double slide_across = velocity.y();
      Place& here = place(lane, i);
      if (is_new) here.state = {};
      here.state.slide(part * slide_along * per_k, part * slide_across * per_k);
      double along_share = here.state.along + damping * slide_along;
      double across_share = here.state.across + damping * slide_across;
      const double square = along_share * along_share + across_share * across_share;
      if (const double limit = here.state.yield; square > limit * limit) {
        const double to_limit = limit / std::sqrt(square);
        along_share *= to_limit;
        across_share *= to_limit;
      }
      here.value = {along_share, across_share, std::hypot(slide_along, slide_across)};
    }
  }
  touching_ = true;
  rear_ = rear;
  front_ = front;
  first_ = first;
  last_ = last;
}

ShearField::Value ShearField::at_lane(int lane, double along) const {
  const double position = (along + travelled_) / spacing_;
  auto below = static_cast<int64_t>(std::floor(position));
  double part = position - static_cast<double>(below);
  // Beyond the places at an edge: the last value where material leaves, falling to no shear where
  // it came in.
  if (below < first_ || below >= last_) {
    const bool ahead = below >= last_;
    const Value edge = place(lane, ahead ? last_ : first_).value;
    if (ahead != from_front_) return edge;
    const double at_edge = static_cast<double>(ahead ? last_ : first_) * spacing_ - travelled_;
    const double room = ahead ? front_ - at_edge : at_edge - rear_;
    const double left = ahead ? front_ - along : along - rear_;
    const double share = room > 0.0 ? std::clamp(left / room, 0.0, 1.0) : 1.0;
    return {share * edge.along, share * edge.across, edge.sliding};
  }
  const Value& a = place(lane, below).value;
  const Value& b = place(lane, below + 1).value;
  return {a.along + part * (b.along - a.along), a.across + part * (b.across - a.across),
          a.sliding + part * (b.sliding - a.sliding)};
}

ShearField::Value ShearField::at(double along, double across) const {
  if (!touching_) return {};
  const Value left = at_lane(0, along);
  const Value right = at_lane(1, along);
  const double part = std::clamp(0.5 - 0.5 * across / lane_offset_, 0.0, 1.0);  // 0 left, 1 right
  return {left.along + part * (right.along - left.along),
          left.across + part * (right.across - left.across),
          left.sliding + part * (right.sliding - left.sliding)};
}

}  // namespace screed
