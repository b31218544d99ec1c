// Lower surfaces in closed form.
#include "host_sim/soil/footprint.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace screed {
namespace {

/// Share of a square of side `edge` on the inner side of an edge whose distance from its centre is
/// `inside` (negative: outside).
double edge_share(double inside, double edge) {
  return std::clamp(0.5 + inside / edge, 0.0, 1.0);
}

// Below this slope against the vertical a side of a box is a silhouette, not a surface that soil
// touches.
constexpr double kSteep = 0.05;

}  // namespace

Footprint Footprint::track(double half_length, double radius, double width) {
  return {Kind::kTrack, Eigen::Vector3d(half_length, 0.5 * width, 0.0), radius};
}

Footprint Footprint::box(const Eigen::Vector3d& size) {
  return {Kind::kBox, 0.5 * size, 0.0};
}

Footprint Footprint::disc(double radius, double thickness) {
  return {Kind::kDisc, Eigen::Vector3d(radius, radius, 0.5 * thickness), radius};
}

void Footprint::set_pose(const Eigen::Isometry3d& pose) {
  pose_ = pose;
  to_local_ = pose.linear().transpose();
  up_ = to_local_.col(2);
  square_ = up_.x() * up_.x() + up_.z() * up_.z();
  root_ = std::sqrt(square_);
  for (const int wheel : {0, 1}) {
    const double axle = wheel == 0 ? -half_.x() : half_.x();
    lowest_at_[wheel] = axle - radius_ * up_.x() / root_;
    lowest_[wheel] = pose_.translation().z() + axle * up_.x() - radius_ * root_;
  }
}

Eigen::Vector3d Footprint::world_reach() const {
  const Eigen::Vector3d half =
      kind_ == Kind::kTrack ? Eigen::Vector3d(half_.x() + radius_, half_.y(), radius_) : half_;
  return pose_.linear().cwiseAbs() * half;
}

Eigen::Vector2d Footprint::reach() const {
  return world_reach().head<2>();
}

double Footprint::reach_down() const {
  return world_reach().z();
}

double Footprint::narrow() const {
  switch (kind_) {
    case Kind::kTrack:
      return std::min(2.0 * half_.y(), 2.0 * (half_.x() + radius_));
    case Kind::kBox:
      return 2.0 * std::min(half_.x(), half_.y());
    case Kind::kDisc:
      break;
  }
  return radius_;
}

bool Footprint::at(double x, double y, double edge, FootprintPoint& point) const {
  // The vertical line's point at the height of the body's centre, in local axes; moving up along
  // the line adds up_.
  const double dx = x - pose_.translation().x();
  const double dy = y - pose_.translation().y();
  const Eigen::Vector3d local = dx * to_local_.col(0) + dy * to_local_.col(1);
  switch (kind_) {
    case Kind::kTrack:
      return at_track(local, edge, point);
    case Kind::kBox:
      return at_box(local, edge, point);
    case Kind::kDisc:
      break;
  }
  return at_disc(local, edge, point);
}

bool Footprint::at_track(const Eigen::Vector3d& local, double edge, FootprintPoint& point) const {
  const double ux = up_.x();
  const double uz = up_.z();
  if (square_ < 1e-6) return false;  // lying on its side: the caller uses a box
  // Bottom run (top run when upside down): local z = -+ radius between the axles.
  const double side = uz > 0.0 ? -1.0 : 1.0;
  double t = 0.0;
  double nx = 0.0;
  double nz = -side;
  double beyond = -ux;  // of the axles, when the line is steep along the run
  bool on_run = false;
  point.flat_within = 0.0;
  if (std::abs(uz) > 1e-9) {
    t = (side * radius_ - local.z()) / uz;
    beyond = local.x() + t * ux;
    point.flat_within = half_.x() - std::abs(beyond);
    on_run = point.flat_within >= 0.0;
  }
  if (!on_run) {
    // The wheel on the side where the line passes beyond the run.
    const double px = local.x() - (beyond >= 0.0 ? half_.x() : -half_.x());
    const double along = px * ux + local.z() * uz;
    const double rest =
        along * along + square_ * (radius_ * radius_ - px * px - local.z() * local.z());
    if (rest <= 0.0) return false;
    t = (-along - std::sqrt(rest)) / square_;
    nx = -(px + t * ux) / radius_;
    nz = -(local.z() + t * uz) / radius_;
  }
  const double across = local.y() + t * up_.y();
  point.share = edge_share(half_.y() - std::abs(across), edge);
  if (point.share <= 0.0) return false;
  point.height = pose_.translation().z() + t;
  point.normal = nx * pose_.linear().col(0) + nz * pose_.linear().col(2);
  // The lowest points of both wheels at this place across the belt: those ahead have passed over
  // (x, y).
  const double here = local.x() + t * ux;
  const double tilt = across * up_.y();
  point.passed_forward = point.passed_backward = point.height;
  for (const int wheel : {0, 1}) {
    double& passed = lowest_at_[wheel] > here ? point.passed_forward : point.passed_backward;
    passed = std::min(passed, lowest_[wheel] + tilt);
  }
  return point.normal.z() > 1e-3;
}

bool Footprint::at_box(const Eigen::Vector3d& local, double edge, FootprintPoint& point) const {
  double enter = -std::numeric_limits<double>::infinity();
  double leave = std::numeric_limits<double>::infinity();
  double share = 1.0;
  int face = 2;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(up_[axis]) < kSteep) continue;
    const double low = (-half_[axis] - local[axis]) / up_[axis];
    const double high = (half_[axis] - local[axis]) / up_[axis];
    if (std::min(low, high) > enter) {
      enter = std::min(low, high);
      face = axis;
    }
    leave = std::min(leave, std::max(low, high));
  }
  if (enter >= leave) return false;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(up_[axis]) >= kSteep) continue;
    share *= edge_share(half_[axis] - std::abs(local[axis] + enter * up_[axis]), edge);
  }
  if (share <= 0.0) return false;
  point.share = share;
  point.height = pose_.translation().z() + enter;
  point.flat_within = 0.0;
  point.passed_forward = point.passed_backward = point.height;
  point.normal = (up_[face] > 0.0 ? 1.0 : -1.0) * to_local_.row(face).transpose();
  return true;
}

bool Footprint::at_disc(const Eigen::Vector3d& local, double edge, FootprintPoint& point) const {
  if (std::abs(up_.z()) < 0.5) return false;
  const double side = up_.z() > 0.0 ? -1.0 : 1.0;
  const double t = (side * half_.z() - local.z()) / up_.z();
  const double distance = std::hypot(local.x() + t * up_.x(), local.y() + t * up_.y());
  point.share = edge_share(radius_ - distance, edge);
  if (point.share <= 0.0) return false;
  point.height = pose_.translation().z() + t;
  point.flat_within = radius_ - distance;
  point.passed_forward = point.passed_backward = point.height;
  point.normal = -side * to_local_.row(2).transpose();
  return true;
}

}  // namespace screed
