// Ways of footprints, and how far a body sinks.
#include "host_sim/physics/soil/sinking.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "host_sim/core/cholesky.h"
#include "host_sim/core/constants.h"

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

// Newton's method on three unknowns: how far a body sinks and tilts on its soil springs in one
// step.
//
//   q        = (up, roll, pitch), displacement in this step, m, rad, about the world's x and y
//   d_i      = -(q0 + q1 y_i - q2 x_i)                downward displacement at spring i, m
//   f_i      = max(0, min(elastic + elastic_slope d_i, virgin + virgin_slope d_i,
//                         flowing + flowing_slope max(0, d_i))) + damper max(0, d_i)
//   external = gravity at first contact, then (rate - memory.rate) / dt - memory.soil_acceleration
//   q_free   = dt rate + dt^2 external                where the body goes without soil
// Wanted: M / dt^2 (q - q_free) = sum of f_i (1, y_i, -x_i), the minimum of a convex energy. Yaw is
// free, so M's block of roll and pitch is the inverse of that block of the inverse inertia.
// Line search: a full Newton step, shortened by the secant while the energy's slope along it
// exceeds 0.3 of the magnitude of its initial (negative) slope.

namespace {

// What else pushes a body is a guess from the last step, kept sane.
constexpr double kMaxAcceleration = 500.0;         // m/s^2
constexpr double kMaxAngularAcceleration = 1.0e4;  // rad/s^2
// Stands for a body that the soil does not tilt: its inertia, over its mass, m^2.
constexpr double kNoTilt_m2 = 1e6;
// Of the displacement: E times this is some hundredths of a pascal.
constexpr double kConverged_m = 1e-10;
constexpr double kTiltArm_m = 0.1;  // at which a tilt is felt
constexpr int kMaxEvaluations = 60;

/// Sum of forces and their slope.
struct Support {
  Eigen::Vector3d force;
  Eigen::Matrix3d stiffness;
};

Support support(std::span<const SpringBlock> springs, const Eigen::Vector3d& q, bool damped,
                const Kernels& kernels) {
  SpringSums s;
  kernels.spring_sums(springs.data(), springs.size(), {q.x(), q.y(), q.z()}, damped, s);
  Support sum;
  sum.force << s.f, s.fy, -s.fx;
  sum.stiffness << s.k, s.ky, -s.kx, s.ky, s.kyy, -s.kxy, -s.kx, -s.kxy, s.kxx;
  return sum;
}

}  // namespace

int solve_sinking(const PressingBody& body, double dt, std::span<SpringBlock> springs, bool damped,
                  BodyMemory& memory, const Kernels& kernels) {
  if (!std::isfinite(body.mass_kg)) return 0;
  const bool tilts = !body.inverse_inertia.isZero(0.0);
  Eigen::Matrix3d mobility = Eigen::Matrix3d::Zero();  // acceleration by force
  mobility(0, 0) = 1.0 / body.mass_kg;
  mobility.bottomRightCorner<2, 2>() =
      tilts ? Eigen::Matrix2d(body.inverse_inertia.topLeftCorner<2, 2>())
            : Eigen::Matrix2d(Eigen::Matrix2d::Identity() / (body.mass_kg * kNoTilt_m2));
  Eigen::Matrix3d mass_per_dt2 = Eigen::Matrix3d::Zero();
  mass_per_dt2(0, 0) = body.mass_kg;
  mass_per_dt2.bottomRightCorner<2, 2>() = mobility.bottomRightCorner<2, 2>().inverse();
  mass_per_dt2 /= dt * dt;

  const Eigen::Vector3d rate(body.velocity.z(), tilts ? body.omega.x() : 0.0,
                             tilts ? body.omega.y() : 0.0);
  Eigen::Vector3d external(-kGravity_m_per_s2, 0.0, 0.0);
  if (memory.touching) external = (rate - memory.rate) / dt - memory.soil_acceleration;
  external.x() = std::clamp(external.x(), -kMaxAcceleration, kMaxAcceleration);
  for (const int i : {1, 2}) {
    external[i] = std::clamp(external[i], -kMaxAngularAcceleration, kMaxAngularAcceleration);
  }
  const Eigen::Vector3d q_free = rate * dt + external * (dt * dt);

  Eigen::Vector3d q = Eigen::Vector3d::Zero();
  Support at = support(springs, q, damped, kernels);
  Eigen::Vector3d gradient = mass_per_dt2 * (q - q_free) - at.force;
  int evaluations = 0;
  while (evaluations < kMaxEvaluations) {
    const Eigen::Matrix3d hessian = mass_per_dt2 + at.stiffness;
    const Eigen::Vector3d direction = -solve_positive(hessian, gradient);
    const double initial_slope = gradient.dot(direction);
    if (!(initial_slope < 0.0)) break;
    // Along the direction the energy's slope rises; a full step that overshoots is taken back to
    // near its lowest place.
    double step = 1.0;
    Eigen::Vector3d next;
    for (;;) {
      ++evaluations;
      next = q + step * direction;
      at = support(springs, next, damped, kernels);
      gradient = mass_per_dt2 * (next - q_free) - at.force;
      const double slope = gradient.dot(direction);
      if (slope <= -0.3 * initial_slope || evaluations >= kMaxEvaluations) break;
      step *= std::clamp(initial_slope / (initial_slope - slope), 0.1, 0.9);  // secant
    }
    const Eigen::Vector3d moved = next - q;
    q = next;
    // The remaining displacement is at most what the inertia alone would leave.
    const double remaining = std::abs(gradient.x()) / mass_per_dt2(0, 0) +
                             kTiltArm_m * (std::abs(gradient.y()) / mass_per_dt2(1, 1) +
                                           std::abs(gradient.z()) / mass_per_dt2(2, 2));
    const double moved_by =
        std::abs(moved.x()) + kTiltArm_m * (std::abs(moved.y()) + std::abs(moved.z()));
    if (std::min(remaining, moved_by) < kConverged_m) break;
  }
  kernels.spring_sinking(springs.data(), springs.size(), {q.x(), q.y(), q.z()});
  memory.touching = true;
  memory.rate = rate;
  memory.soil_acceleration = mobility * at.force;
  return evaluations;
}

}  // namespace screed
