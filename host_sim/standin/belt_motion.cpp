// One implicit step: forces are those of the motion at its end, linear in it.
#include "host_sim/standin/belt_motion.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "hal/sample.h"
#include "host_sim/core/gravity.h"

namespace screed {
namespace {

constexpr double kFrame_s = 1.0 / kTickRate_hz;
constexpr double kRollingSpeed_m_per_s = 0.01;  // at which rolling resists in full
constexpr double kMinContact_m = 0.002;         // of a patch: what touches less is as much

// std::hypot guards against overflows that there are none of, and takes ten times as long.
double length_of(double x, double y) {
  return std::sqrt(x * x + y * y);
}

double along_slope(double slope) {
  return std::sqrt(1.0 + slope * slope);
}

/// Pressed to the ground by so much, N.
double weight_on(const BeltSupport& support, double mass_kg) {
  return mass_kg * kGravity_m_per_s2 /
         std::sqrt(1.0 + support.forward * support.forward + support.left * support.left);
}

/// What is carried along at this rate, 1/s, from one patch to the next, while it wears off at that
/// one: the rate at which an upwind difference is right in the steady state.
double fitted_rate(double carrying, double wearing) {
  if (carrying <= 0.0) return 0.0;
  const double a = wearing / carrying;
  return a < 1e-6 ? carrying : wearing / std::expm1(a);
}

}  // namespace

BeltSupport level_support(const TrackGeometry& tracks) {
  BeltSupport support;
  for (auto& belt : support.load) belt.fill(1.0 / (2.0 * kBeltPatches));
  for (auto& belt : support.area) {
    belt.fill(2.0 * tracks.half_length_m * tracks.width_m / kBeltPatches);
  }
  support.front.fill(tracks.half_length_m);
  support.rear.fill(-tracks.half_length_m);
  return support;
}

BeltShear& BeltShear::operator+=(const BeltShear& more) {
  forward_m += more.forward_m;
  left_m += more.left_m;
  length_m += more.length_m;
  for (std::size_t i = 0; i < kBeltPatches; ++i) patch_m[i] += more.patch_m[i];
  slid_m += more.slid_m;
  moved_m += more.moved_m;
  return *this;
}

/// matrix * motion = sum, of forward and sideways speed and rate of turn. The matrix is symmetric
/// and positive definite; forward and sideways are not coupled.
struct BeltMotion::System {
  double forward, left, turn;      ///< of the diagonal
  double forward_turn, left_turn;  ///< beside it
  double sum_forward, sum_left, sum_turn;

  void add(double to_forward, double to_left, double to_turn) {
    sum_forward += to_forward;
    sum_left += to_left;
    sum_turn += to_turn;
  }
  /// By Cholesky's decomposition, written out: Eigen's for any size takes twice as long for three.
  Eigen::Vector3d motion() const {
    const double l00 = std::sqrt(forward);
    const double l20 = forward_turn / l00;
    const double l11 = std::sqrt(left);
    const double l21 = left_turn / l11;
    const double l22 = std::sqrt(turn - (l20 * l20 + l21 * l21));
    const double y0 = sum_forward / l00;
    const double y1 = sum_left / l11;
    const double y2 = (sum_turn - (l20 * y0 + l21 * y1)) / l22;
    const double z2 = y2 / l22;
    return {(y0 - l20 * z2) / l00, (y1 - l21 * z2) / l11, z2};
  }
};

BeltMotion::BeltMotion(const TrackGeometry& tracks, const SoilParameters& soil, const BeltFit& fit)
    : fit_(fit),
      mass_kg_(tracks.mass_kg),
      inertia_kg_m2_(tracks.yaw_inertia_kg_m2),
      half_tread_m_(tracks.half_tread_m),
      patch_m_(2.0 * tracks.half_length_m / kPatches),
      cohesion_pa_(soil.cohesion_pa),
      tan_friction_(std::tan(soil.friction_deg * std::numbers::pi / 180.0)),
      per_modulus_(1.0 / soil.shear_modulus_m) {
  for (auto& belt : patches_) {
    for (std::size_t i = 0; i < kPatches; ++i) {
      belt[i].x = patch_m_ * (0.5 * (kPatches - 1) - static_cast<double>(i));
    }
  }
}

void BeltMotion::set_motion(const FrameMotion& motion, const BeltSupport& support) {
  forward_ = motion.forward_m / kFrame_s * along_slope(support.forward);
  left_ = motion.sideways_m / kFrame_s * along_slope(support.left);
  turn_ = motion.turn_rad / kFrame_s;
}

/// What is mobilised travels with the belt, from its leading end on; the soil ahead is fresh.
void BeltMotion::carry(std::array<Patch, kPatches>& belt, double speed) const {
  double forward = 0.0;
  double left = 0.0;
  double before_m = 0.0;  // what touches of the patch before
  for (std::size_t k = 0; k < kPatches; ++k) {
    Patch& patch = belt[speed >= 0.0 ? k : kPatches - 1 - k];
    if (patch.touching_m <= 0.0) {
      patch.forward = patch.left = 0.0;
      continue;  // before contact begins, or after its end
    }
    // From the middle of what touches of the patch before, or from where contact begins.
    const double way = std::max(kMinContact_m, 0.5 * (before_m + patch.touching_m));
    before_m = patch.touching_m;
    const double share =
        std::min(1.0, kFrame_s * fitted_rate(std::abs(speed) / way, patch.slip * per_modulus_));
    const double forward_before = patch.forward;
    const double left_before = patch.left;
    patch.forward += share * (forward - patch.forward);
    patch.left += share * (left - patch.left);
    forward = forward_before;
    left = left_before;
  }
}

/// The patch's force at the end of the frame: strength (m + per_slip dt slip'), where slip' is what
/// the motion at the end makes it. How fast m wears off comes from the motion before.
void BeltMotion::shear_patch(Patch& patch, double y, double speed, System& system) const {
  const double x = patch.x;
  patch.slip = length_of(speed - forward_ + turn_ * y, left_ + turn_ * x);
  const double kept = 1.0 / (1.0 + kFrame_s * patch.slip * per_modulus_);
  patch.forward *= kept;
  patch.left *= kept;
  patch.per_slip = kept * per_modulus_;
  const double along = kFrame_s * patch.strength;
  const double across = fit_.sideways * along;
  const double k = kFrame_s * along * patch.per_slip;
  const double ks = kFrame_s * across * patch.per_slip;
  const double forward = along * patch.forward + k * speed;
  const double left = across * patch.left;
  system.add(forward, left, left * x - forward * y);
  system.forward += k;
  system.forward_turn -= k * y;
  system.left += ks;
  system.left_turn += ks * x;
  system.turn += k * y * y + ks * x * x;
}

BeltShear BeltMotion::finish(std::array<Patch, kPatches>& belt, double y, double speed) const {
  BeltShear shear;
  const double along = kFrame_s * (speed - forward_ + turn_ * y);
  for (std::size_t i = 0; i < kPatches; ++i) {
    Patch& patch = belt[i];
    const double across = -kFrame_s * (left_ + turn_ * patch.x);
    patch.forward += patch.per_slip * along;
    patch.left += patch.per_slip * across;
    const double mobilised = length_of(patch.forward, patch.left);
    shear.patch_m[i] = mobilised * length_of(along, across);
    shear.forward_m += mobilised * along / kPatches;
    shear.left_m += mobilised * across / kPatches;
    shear.length_m += shear.patch_m[i] / kPatches;
  }
  shear.slid_m = std::abs(along);
  shear.moved_m = kFrame_s * std::max(std::abs(speed), std::abs(forward_ - turn_ * y));
  return shear;
}

/// What the soil below both belts, and rolling, does to the robot.
void BeltMotion::shear_belts(const std::array<double, 2>& speeds, const BeltSupport& support,
                             System& system) {
  const double weight = weight_on(support, mass_kg_);
  for (std::size_t side = 0; side < 2; ++side) {
    auto& belt = patches_[side];
    const double y = middle(side);
    for (std::size_t i = 0; i < kPatches; ++i) {
      const double front = std::min(support.front[side], belt[i].x + 0.5 * patch_m_);
      const double rear = std::max(support.rear[side], belt[i].x - 0.5 * patch_m_);
      belt[i].touching_m = std::max(0.0, front - rear);
    }
    carry(belt, speeds[side]);
    double load = 0.0;
    for (std::size_t i = 0; i < kPatches; ++i) {
      const double carries = weight * support.load[side][i];
      load += carries;
      belt[i].strength = cohesion_pa_ * support.area[side][i] + carries * tan_friction_;
      shear_patch(belt[i], y, speeds[side], system);
    }
    const double rolling = kFrame_s * fit_.rolling * load *
                           std::clamp((forward_ - turn_ * y) / kRollingSpeed_m_per_s, -1.0, 1.0);
    system.add(-rolling, 0.0, rolling * y);
  }
}

void BeltMotion::finish_belts(const std::array<double, 2>& speeds) {
  for (std::size_t side = 0; side < 2; ++side) {
    shear_[side] = finish(patches_[side], middle(side), speeds[side]);
    traction_n_[side] = 0.0;
    for (const Patch& patch : patches_[side]) {
      traction_n_[side] += patch.strength * patch.forward;
    }
  }
}

FrameMotion BeltMotion::step(double left_m_per_s, double right_m_per_s, const BeltSupport& support,
                             const Eigen::Vector3d& push) {
  const std::array<double, 2> speeds = {left_m_per_s, right_m_per_s};
  System system{mass_kg_, mass_kg_, inertia_kg_m2_, 0.0, 0.0, 0.0, 0.0, 0.0};
  // The body turns, its axes with it.
  system.add(mass_kg_ * (forward_ + kFrame_s * turn_ * left_),
             mass_kg_ * (left_ - kFrame_s * turn_ * forward_), inertia_kg_m2_ * turn_);
  const double downhill = kFrame_s * weight_on(support, mass_kg_);
  system.add(-downhill * support.forward, -downhill * support.left, 0.0);
  system.add(kFrame_s * push[0], kFrame_s * push[1], kFrame_s * push[2]);
  shear_belts(speeds, support, system);
  const Eigen::Vector3d motion = system.motion();
  forward_ = motion[0];
  left_ = motion[1];
  turn_ = motion[2];
  finish_belts(speeds);
  return {kFrame_s * forward_ / along_slope(support.forward),
          kFrame_s * left_ / along_slope(support.left), kFrame_s * turn_};
}

void BeltMotion::follow(double left_m_per_s, double right_m_per_s, const BeltSupport& support,
                        const FrameMotion& motion) {
  const std::array<double, 2> speeds = {left_m_per_s, right_m_per_s};
  System unused{};
  set_motion(motion, support);
  shear_belts(speeds, support, unused);
  finish_belts(speeds);
}

}  // namespace screed
