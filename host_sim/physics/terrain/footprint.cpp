// Lower surfaces in closed form.
//
// A vertical line at (x, y) is, in the body's axes, l + t u: l its point at the height of the
// body's centre, u the world's vertical (up_), t the height over the centre, m. It enters a convex
// body at the lowest t.
//
// Track, a capsule in the local x-z plane round axles at -+half, radius r:
//   lower run  l_z + t u_z = run_z = -+r               t = run_t, where |l_x + t u_x| <= half
//   wheel      |(p_x, l_z) + t (u_x, u_z)|^2 = r^2,    p_x = l_x - hub
//              square = u_x^2 + u_z^2,  along = p_x u_x + l_z u_z
//              discriminant = along^2 + square (r^2 - p_x^2 - l_z^2)
//              t = (-along - sqrt(discriminant)) / square,   none where discriminant <= 0
//   normal     r times, into the body: n = -(p_x + t u_x, 0, l_z + t u_z); slopes are its parts
//              along the world's x and y over that along z
//   share      1/2 + (width - |l_y + t u_y|) / edge, within 0..1: of a square of this side, across
//              the track's side
//   passed     each wheel swept the ground down to the plane z = gradient x - deep that touches it
//              from below in x = touch; where that point is ahead, the line meets the plane at
//              t = (gradient l_x - deep - l_z) / (u_z - gradient u_x)
// Box: t between the planes of each pair of faces, the largest of the lower ones (slabs; Kay and
// Kajiya, Ray tracing complex scenes, 1986). Disc: t where the line meets the plane of its end.
#include "host_sim/physics/terrain/footprint.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host_sim/core/elementary.h"
#include "host_sim/physics/kernels/triple.h"

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
}

Eigen::Vector3d Footprint::local_half() const {
  return kind_ == Kind::kTrack ? Eigen::Vector3d(half_.x() + radius_, half_.y(), radius_) : half_;
}

Eigen::Vector3d Footprint::world_reach() const {
  return pose_.linear().cwiseAbs() * local_half();
}

Eigen::Vector2d Footprint::reach() const {
  return world_reach().head<2>();
}

// Of a track's points in its x-z plane only those near the lowest one are as low as `level`: within
// a segment of the circle round each axle.
double Footprint::reach_below(double level, const Eigen::Vector2d& direction) const {
  const Eigen::Matrix3d& axes = pose_.linear();
  const auto extent = [&](const Eigen::Vector3d& axis) {
    return std::abs(axis.head<2>().dot(direction));
  };
  if (kind_ != Kind::kTrack || square_ < 1e-6) {
    const Eigen::Vector3d half = local_half();
    return half.x() * extent(axes.col(0)) + half.y() * extent(axes.col(1)) +
           half.z() * extent(axes.col(2));
  }
  const double tilt = half_.y() * std::abs(up_.y());
  const double deep =
      (pose_.translation().z() - half_.x() * std::abs(up_.x()) - tilt - level) / root_;
  if (deep >= radius_) return -1.0;
  const double half_chord =
      std::sqrt(radius_ * radius_ - std::max(0.0, deep) * std::max(0.0, deep));
  const Eigen::Vector3d level_forward = (up_.z() * axes.col(0) - up_.x() * axes.col(2)) / root_;
  return half_.x() * extent(axes.col(0)) + half_chord * extent(level_forward) +
         (half_.y() + radius_ * std::abs(up_.y()) / root_) * extent(axes.col(1));
}

double Footprint::reach_down() const {
  return world_reach().z();
}

double Footprint::radius_from_above() const {
  const Eigen::Vector3d reach = world_reach();
  return portable::hypot(reach.x(), reach.y());
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

RunFrame Footprint::run_frame() const {
  const Eigen::Matrix3d& world = pose_.linear();
  int below = 2;
  int ahead = 0;
  if (kind_ == Kind::kBox) {
    up_.cwiseAbs().maxCoeff(&below);
    ahead = below == 0 ? 1 : 0;
  }
  const double sense = up_[below] < 0.0 ? -1.0 : 1.0;
  RunFrame frame;
  frame.axes.col(0) = world.col(ahead);
  frame.axes.col(2) = sense * world.col(below);
  frame.axes.col(1) = frame.axes.col(2).cross(frame.axes.col(0));
  const bool track = kind_ == Kind::kTrack;
  frame.contour.half_m = half_[ahead];
  frame.contour.radius_m = track ? radius_ : 0.0;
  frame.contour.below_m = track ? radius_ : half_[below];
  frame.contour.half_width_m = half_[3 - ahead - below];
  frame.sense = sense;
  frame.face = 2 * below + (sense < 0.0 ? 1 : 0);
  return frame;
}

Eigen::Vector3d Footprint::plane_below() const {
  int axis = 2;
  if (kind_ == Kind::kBox) up_.cwiseAbs().maxCoeff(&axis);
  if (kind_ == Kind::kTrack || std::abs(up_[axis]) < 0.5) {
    return {-std::numeric_limits<double>::infinity(), 0.0, 0.0};
  }
  // Outward normal of the face that looks down; the body is where normal . (p - centre) <= half.
  const Eigen::Vector3d normal = (up_[axis] > 0.0 ? -1.0 : 1.0) * pose_.linear().col(axis);
  return {half_[axis] / normal.z(), -normal.x() / normal.z(), -normal.y() / normal.z()};
}

double Footprint::lowest_at_rim(double edge) const {
  if (has_corners()) return pose_.translation().z() - reach_down();
  // Such a square overlaps the outline by less than 1.5 edge. There the wheel's surface is
  // sqrt(b (2 r - b)) below its axle, b = `beyond`.
  const double beyond = 1.5 * edge;
  const double below = std::sqrt(beyond * std::max(0.0, 2.0 * radius_ - beyond));
  return pose_.translation().z() - half_.x() * std::abs(up_.x()) - half_.y() * std::abs(up_.y()) -
         (beyond < radius_ ? below : radius_) - std::abs(up_.x()) * radius_;
}

void FootprintSamples::clear(size_t room) {
  count = 0;
  room = whole_blocks(room);
  if (x.size() >= room) return;
  for (std::vector<double>* array :
       {&x, &y, &share, &height, &slope_x, &slope_y, &flat_within, &passed}) {
    array->resize(2 * room);
  }
}

void FootprintSamples::fill_block() {
  for (size_t i = count; i < whole_blocks(count); ++i) {
    x[i] = x[count - 1];
    y[i] = y[count - 1];
  }
}

void Footprint::surface(double edge, const PathHistory& path, FootprintSamples& samples,
                        const Kernels& kernels, size_t first) const {
  surface(edge, &path, samples, kernels, first);
}

void Footprint::surface(double edge, FootprintSamples& samples, const Kernels& kernels) const {
  surface(edge, nullptr, samples, kernels, 0);
}

void Footprint::surface(double edge, const PathHistory* path, FootprintSamples& samples,
                        const Kernels& kernels, size_t first) const {
  samples.fill_block();
  switch (kind_) {
    case Kind::kTrack:
      track_surface(edge, path, samples, kernels, first);
      return;
    case Kind::kBox:
      box_surface(edge, samples, first);
      return;
    case Kind::kDisc:
      break;
  }
  disc_surface(edge, samples, first);
}

// Eight sample points at a time, without branches (kernels/track_surface.inc).
void Footprint::track_surface(double edge, const PathHistory* path, FootprintSamples& samples,
                              const Kernels& kernels, size_t first) const {
  if (square_ < 1e-6) {  // lying on its side: the caller uses a box
    std::fill(samples.share.begin(), samples.share.end(), 0.0);
    return;
  }
  const Eigen::Matrix3d& axes = pose_.linear();
  TrackShape shape{};
  shape.belt = half_.x() > 0.0;
  // Bottom run (top run when upside down): local z = -+ radius between the axles. None when the
  // belt stands on end.
  shape.has_run = shape.belt && std::abs(up_.z()) > 1e-9;
  shape.has_path = path != nullptr;
  shape.centre = triple(pose_.translation());
  shape.axis_x = triple(axes.col(0));
  shape.axis_y = triple(axes.col(1));
  shape.axis_z = triple(axes.col(2));
  shape.up = triple(up_);
  shape.square = square_;
  shape.radius = radius_;
  shape.half = half_.x();
  shape.width = half_.y();
  shape.edge = edge;
  const double side = up_.z() > 0.0 ? -1.0 : 1.0;
  shape.run_z = side * radius_;
  // Along the path each wheel swept down to a plane along the path that touches it from below, and
  // has passed where the touching point is ahead, in the sense in which the body came. In local
  // axes the plane is z = gradient * x - deep.
  const PathHistory travelled = path != nullptr ? *path : PathHistory{};
  shape.sense = travelled.travel_m > 0.0 ? 1.0 : -1.0;
  shape.gradient = travelled.gradient;
  const double slant = std::sqrt(1.0 + travelled.gradient * travelled.gradient);
  const double climb =
      up_.z() - travelled.gradient * up_.x();  // of a vertical line against that plane
  const bool crosses_swept_plane = std::abs(climb) > kSteep;
  shape.reach = crosses_swept_plane ? std::abs(travelled.travel_m) : -1.0;
  shape.per_climb = crosses_swept_plane ? 1.0 / climb : 0.0;
  for (const int wheel : {0, 1}) {
    const double axle = wheel == 0 ? -half_.x() : half_.x();
    shape.deep[wheel] = travelled.gradient * axle - side * radius_ * slant;
    shape.touch[wheel] = axle - side * radius_ * travelled.gradient / slant;
  }
  kernels.track_surface(shape, samples.points(first), whole_blocks(samples.count) - first);
}

void Footprint::box_surface(double edge, FootprintSamples& samples, size_t first) const {
  for (size_t i = first; i < samples.count; ++i) {
    const double dx = samples.x[i] - pose_.translation().x();
    const double dy = samples.y[i] - pose_.translation().y();
    const Eigen::Vector3d local = dx * to_local_.col(0) + dy * to_local_.col(1);
    samples.share[i] = 0.0;
    samples.flat_within[i] = 0.0;
    double enter = -std::numeric_limits<double>::infinity();
    double leave = std::numeric_limits<double>::infinity();
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
    if (enter >= leave) continue;
    double share = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
      if (std::abs(up_[axis]) >= kSteep) continue;
      share *= edge_share(half_[axis] - std::abs(local[axis] + enter * up_[axis]), edge);
    }
    const Eigen::Vector3d normal = (up_[face] > 0.0 ? 1.0 : -1.0) * to_local_.row(face).transpose();
    samples.share[i] = share;
    samples.height[i] = samples.passed[i] = pose_.translation().z() + enter;
    samples.slope_x[i] = normal.x() / normal.z();
    samples.slope_y[i] = normal.y() / normal.z();
  }
}

void Footprint::disc_surface(double edge, FootprintSamples& samples, size_t first) const {
  if (std::abs(up_.z()) < 0.5) {
    std::fill(samples.share.begin(), samples.share.end(), 0.0);
    return;
  }
  const double side = up_.z() > 0.0 ? -1.0 : 1.0;
  const Eigen::Vector3d normal = -side * to_local_.row(2).transpose();
  for (size_t i = first; i < samples.count; ++i) {
    const double dx = samples.x[i] - pose_.translation().x();
    const double dy = samples.y[i] - pose_.translation().y();
    const Eigen::Vector3d local = dx * to_local_.col(0) + dy * to_local_.col(1);
    const double t = (side * half_.z() - local.z()) / up_.z();
    const double distance = portable::hypot(local.x() + t * up_.x(), local.y() + t * up_.y());
    samples.share[i] = edge_share(radius_ - distance, edge);
    samples.height[i] = samples.passed[i] = pose_.translation().z() + t;
    samples.slope_x[i] = normal.x() / normal.z();
    samples.slope_y[i] = normal.y() / normal.z();
    samples.flat_within[i] = radius_ - distance;
  }
}

}  // namespace screed
