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

#include "host_sim/physics/terrain/double2.h"

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

Eigen::Vector3d Footprint::world_reach() const {
  const Eigen::Vector3d half =
      kind_ == Kind::kTrack ? Eigen::Vector3d(half_.x() + radius_, half_.y(), radius_) : half_;
  return pose_.linear().cwiseAbs() * half;
}

Eigen::Vector2d Footprint::reach() const {
  return world_reach().head<2>();
}

// Of a track's points in its x-z plane only those near the lowest one are as low as `level`: within
// a segment of the circle round each axle.
Eigen::Vector2d Footprint::reach_below(double level) const {
  if (kind_ != Kind::kTrack || square_ < 1e-6) return world_reach().head<2>();
  const double tilt = half_.y() * std::abs(up_.y());
  const double deep =
      (pose_.translation().z() - half_.x() * std::abs(up_.x()) - tilt - level) / root_;
  if (deep >= radius_) return {-1.0, -1.0};
  const double half_chord =
      std::sqrt(radius_ * radius_ - std::max(0.0, deep) * std::max(0.0, deep));
  const Eigen::Matrix3d& axes = pose_.linear();
  const Eigen::Vector2d forward = axes.col(0).head<2>().cwiseAbs();
  const Eigen::Vector2d axle = axes.col(1).head<2>().cwiseAbs();
  const Eigen::Vector2d level_forward =
      ((up_.z() * axes.col(0) - up_.x() * axes.col(2)) / root_).head<2>().cwiseAbs();
  return half_.x() * forward + half_chord * level_forward +
         (half_.y() + radius_ * std::abs(up_.y()) / root_) * axle;
}

double Footprint::reach_down() const {
  return world_reach().z();
}

double Footprint::radius_from_above() const {
  const Eigen::Vector3d reach = world_reach();
  return std::hypot(reach.x(), reach.y());
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
  room += room % 2;  // whole pairs
  if (x.size() >= room) return;
  for (std::vector<double>* array :
       {&x, &y, &share, &height, &slope_x, &slope_y, &flat_within, &passed}) {
    array->resize(room);
  }
}

void Footprint::surface(double edge, const PathHistory& path, FootprintSamples& samples) const {
  surface(edge, &path, samples);
}

void Footprint::surface(double edge, FootprintSamples& samples) const {
  surface(edge, nullptr, samples);
}

void Footprint::surface(double edge, const PathHistory* path, FootprintSamples& samples) const {
  if (samples.count % 2 != 0) {  // whole pairs
    samples.x[samples.count] = samples.x[samples.count - 1];
    samples.y[samples.count] = samples.y[samples.count - 1];
  }
  switch (kind_) {
    case Kind::kTrack:
      if (half_.x() > 0.0) {
        track_surface<true>(edge, path, samples);
      } else {
        track_surface<false>(edge, path, samples);
      }
      return;
    case Kind::kBox:
      box_surface(edge, samples);
      return;
    case Kind::kDisc:
      break;
  }
  disc_surface(edge, samples);
}

// Two sample points at a time, without branches.
template <bool kBelt>
void Footprint::track_surface(double edge, const PathHistory* path,
                              FootprintSamples& samples) const {
  if (square_ < 1e-6) {  // lying on its side: the caller uses a box
    std::fill(samples.share.begin(), samples.share.end(), 0.0);
    return;
  }
  const Double2 zero = broadcast(0.0);
  const Eigen::Matrix3d& axes = pose_.linear();
  const Double2 cx = broadcast(pose_.translation().x());
  const Double2 cy = broadcast(pose_.translation().y());
  const Double2 cz = broadcast(pose_.translation().z());
  // The vertical line's point at the height of the body's centre, in local axes; moving up along
  // the line adds `up`.
  const Double2 xx = broadcast(to_local_(0, 0));
  const Double2 xy = broadcast(to_local_(0, 1));
  const Double2 yx = broadcast(to_local_(1, 0));
  const Double2 yy = broadcast(to_local_(1, 1));
  const Double2 zx = broadcast(to_local_(2, 0));
  const Double2 zy = broadcast(to_local_(2, 1));
  const Double2 ux = broadcast(up_.x());
  const Double2 uy = broadcast(up_.y());
  const Double2 uz = broadcast(up_.z());
  const Double2 square = broadcast(square_);
  const Double2 per_square = broadcast(1.0 / square_);
  const Double2 radius_square = broadcast(radius_ * radius_);
  const Double2 half = broadcast(half_.x());
  const Double2 width = broadcast(half_.y());
  const Double2 per_edge = broadcast(1.0 / edge);
  // Bottom run (top run when upside down): local z = -+ radius between the axles. None when the
  // belt stands on end.
  const bool has_run = kBelt && std::abs(up_.z()) > 1e-9;
  const Double2 per_uz = broadcast(has_run ? 1.0 / up_.z() : 0.0);
  const double side = up_.z() > 0.0 ? -1.0 : 1.0;
  const Double2 run_z = broadcast(side * radius_);
  // Along the path each wheel swept down to a plane along the path that touches it from below, and
  // has passed where the touching point is ahead, in the sense in which the body came. In local
  // axes the plane is z = gradient * x - deep.
  const PathHistory travelled = path != nullptr ? *path : PathHistory{};
  const Double2 sense = broadcast(travelled.travel_m > 0.0 ? 1.0 : -1.0);
  const Double2 gradient = broadcast(travelled.gradient);
  const double slant = std::sqrt(1.0 + travelled.gradient * travelled.gradient);
  const double climb =
      up_.z() - travelled.gradient * up_.x();  // of a vertical line against that plane
  const bool crosses_swept_plane = std::abs(climb) > kSteep;
  const Double2 reach = broadcast(crosses_swept_plane ? std::abs(travelled.travel_m) : -1.0);
  const Double2 per_climb = broadcast(crosses_swept_plane ? 1.0 / climb : 0.0);
  Double2 deep[2];
  Double2 touch[2];
  for (const int wheel : {0, 1}) {
    const double axle = wheel == 0 ? -half_.x() : half_.x();
    deep[wheel] = broadcast(travelled.gradient * axle - side * radius_ * slant);
    touch[wheel] = broadcast(axle - side * radius_ * travelled.gradient / slant);
  }
  // Normals over their vertical part, of local (nx, 0, nz): nx and nz times these, world x, y, z.
  const Double2 x0 = broadcast(axes(0, 0));
  const Double2 y0 = broadcast(axes(1, 0));
  const Double2 z0 = broadcast(axes(2, 0));
  const Double2 x2 = broadcast(axes(0, 2));
  const Double2 y2 = broadcast(axes(1, 2));
  const Double2 z2 = broadcast(axes(2, 2));
  const Double2 steepest = broadcast(1e-3 * radius_);

  for (size_t i = 0; i < samples.count; i += 2) {
    const Double2 dx = load(&samples.x[i]) - cx;
    const Double2 dy = load(&samples.y[i]) - cy;
    const Double2 lx = dx * xx + dy * xy;
    const Double2 ly = dx * yx + dy * yy;
    const Double2 lz = dx * zx + dy * zy;
    Double2 run_t = zero;
    Double2 flat = broadcast(-1.0);
    Double2 hub = zero;
    if constexpr (kBelt) {
      run_t = (run_z - lz) * per_uz;
      const Double2 beyond = has_run ? lx + run_t * ux : -ux;
      if (has_run) flat = half - magnitude(beyond);
      // The wheel on the side where the line passes beyond the run.
      hub = beyond >= zero ? half : -half;
    }
    const Double2 px = lx - hub;
    const Double2 along = px * ux + lz * uz;
    const Double2 discriminant = along * along + square * (radius_square - px * px - lz * lz);
    const Double2 wheel_t = (-along - square_root(maximum(discriminant, zero))) * per_square;
    // Times the radius, into the body.
    Double2 nx = -(px + wheel_t * ux);
    Double2 nz = -(lz + wheel_t * uz);
    Double2 t = wheel_t;
    auto hit = discriminant > zero;
    if constexpr (kBelt) {
      const auto on_run = flat >= zero;
      t = on_run ? run_t : wheel_t;
      nx = on_run ? zero : nx;
      nz = on_run ? -run_z : nz;
      hit = hit | on_run;
    }
    const Double2 wz = nx * z0 + nz * z2;
    hit = hit & (wz > steepest);
    const Double2 per_wz = broadcast(1.0) / maximum(wz, steepest);
    const Double2 across = ly + t * uy;
    const Double2 share = broadcast(0.5) + (width - magnitude(across)) * per_edge;
    store(hit ? minimum(maximum(share, zero), broadcast(1.0)) : zero, &samples.share[i]);
    const Double2 height = cz + t;
    store(height, &samples.height[i]);
    store((nx * x0 + nz * x2) * per_wz, &samples.slope_x[i]);
    store((nx * y0 + nz * y2) * per_wz, &samples.slope_y[i]);
    store(flat, &samples.flat_within[i]);
    if (path == nullptr) continue;
    const Double2 here = lx + t * ux;
    Double2 low = height;
    for (const int wheel : {0, 1}) {
      if (!kBelt && wheel == 1) break;
      const auto ahead = sense * (touch[wheel] - here) > zero;
      low = minimum(low, ahead ? cz + (gradient * lx - deep[wheel] - lz) * per_climb : height);
    }
    store(magnitude(lx) <= reach ? low : height, &samples.passed[i]);
  }
}

void Footprint::box_surface(double edge, FootprintSamples& samples) const {
  for (size_t i = 0; i < samples.count; ++i) {
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

void Footprint::disc_surface(double edge, FootprintSamples& samples) const {
  if (std::abs(up_.z()) < 0.5) {
    std::fill(samples.share.begin(), samples.share.end(), 0.0);
    return;
  }
  const double side = up_.z() > 0.0 ? -1.0 : 1.0;
  const Eigen::Vector3d normal = -side * to_local_.row(2).transpose();
  for (size_t i = 0; i < samples.count; ++i) {
    const double dx = samples.x[i] - pose_.translation().x();
    const double dy = samples.y[i] - pose_.translation().y();
    const Eigen::Vector3d local = dx * to_local_.col(0) + dy * to_local_.col(1);
    const double t = (side * half_.z() - local.z()) / up_.z();
    const double distance = std::hypot(local.x() + t * up_.x(), local.y() + t * up_.y());
    samples.share[i] = edge_share(radius_ - distance, edge);
    samples.height[i] = samples.passed[i] = pose_.translation().z() + t;
    samples.slope_x[i] = normal.x() / normal.z();
    samples.slope_y[i] = normal.y() / normal.z();
    samples.flat_within[i] = radius_ - distance;
  }
}

}  // namespace screed
