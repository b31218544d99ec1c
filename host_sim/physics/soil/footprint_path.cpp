// The way that a footprint came.
#include "host_sim/physics/soil/footprint_path.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace screed {
namespace {

// Greatest gradient of a path: what drops has not driven there.
constexpr double kMaxPathGradient = 1.0;
// Least vertical part of a body's z axis at which a level path has a gradient in the body's axes.
constexpr double kUpright = 1e-3;
// What a footprint comes back by before its path counts as a new one, m: less is trembling.
constexpr double kTurnedBack_m = 0.001;

/// The far end of a path that was lower than the footprint comes up by `sunk`, m, relative to it.
void sink_to_path(double sunk, PathHistory& path) {
  const double far_end = -path.gradient * path.travel_m;
  if (far_end < 0.0) path.gradient *= 1.0 - std::min(1.0, sunk / -far_end);
}

/// How far back a path tells where the surface of a footprint has been that has pitched against it.
double unbent_length(const PathHistory& path) {
  const double bend = std::abs(path.bend_rad);
  return bend > 0.0 ? kPathError_m / bend : std::numeric_limits<double>::infinity();
}

/// How far back a path tells where the surface has been, m.
double path_length(const Footprint& footprint, double along, double turned) {
  const double length = 2.0 * (footprint.half().x() + footprint.radius());
  const double width = footprint.narrow();
  const double turn = std::abs(turned);
  return length * length * turn > width * std::abs(along)
             ? std::sqrt(width * std::abs(along) / turn)
             : length;
}

}  // namespace

void extend_path(const Footprint& footprint, const Eigen::Vector3d& displacement,
                 const Eigen::Vector3d& turned, bool follow_slopes, PathHistory& path) {
  const Eigen::Matrix3d& axes = footprint.pose().linear();
  const double along = displacement.dot(axes.col(0));
  const double sunk = std::max(0.0, -displacement.dot(axes.col(2)));
  const double length = footprint.half().x() + footprint.radius();
  const double share = std::abs(along) / length;
  const double pitched = footprint.is_wheel() ? 0.0 : turned.y();
  path.bend_rad = share < 1.0 ? path.bend_rad + pitched - share * path.bend_rad : 0.0;
  const double unbent = unbent_length(path);
  path.travel_m = std::clamp(path.travel_m, -unbent, unbent);
  if (along * path.travel_m < 0.0) {
    path.back_m += std::abs(along);
    if (path.back_m <= kTurnedBack_m) return sink_to_path(sunk, path);
    path = {};
  } else if (path.back_m > 0.0) {  // back to where it had been
    path.back_m = std::max(0.0, path.back_m - std::abs(along));
    return sink_to_path(sunk, path);
  }
  const double longest = std::min(unbent, path_length(footprint, along, turned.z()));
  path.travel_m = std::clamp(path.travel_m + along, -longest, longest);
  if (!follow_slopes) {
    path.gradient = std::abs(axes(2, 2)) > kUpright ? -axes(2, 0) / axes(2, 2) : 0.0;
    return;
  }
  const double max_rise = kMaxPathGradient * std::abs(along);
  const double up = std::clamp(displacement.dot(axes.col(2)), -max_rise, max_rise) / length;
  path.gradient =
      share < 1.0 ? path.gradient + (along < 0.0 ? -up : up) - share * path.gradient : 0.0;
  if (sunk > max_rise) sink_to_path(sunk - max_rise, path);
}

}  // namespace screed
