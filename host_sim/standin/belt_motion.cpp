// One implicit step: forces are those of the motion at its end, linear in it.
#include "host_sim/standin/belt_motion.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "hal/sample.h"
#include "host_sim/core/constants.h"
#include "host_sim/core/elementary.h"
#include "host_sim/physics/soil/soil_laws.h"

namespace screed {

namespace {
constexpr double kRollingSpeed_m_per_s = 0.01;  // at which rolling resists in full
constexpr double kMinContact_m = 0.002;         // of a patch: what touches less is as much
constexpr double kMinCarrying_per_s = 1e-12;    // of a belt that stands
constexpr double kTouching_m = 1e-9;            // what touches less does not
constexpr double kMinSpeed_m_per_s = 1e-12;     // of a belt that goes somewhere

// What wears off goes by the slip at the end of the frame, which is found by going over it again.
// By the slip at its begin, soil with K = 1.7 mm would hold a seventh less than it does while a
// stroke is caught.
constexpr int kPasses = 3;

double along_slope(double slope) {
  return std::sqrt(1.0 + slope * slope);
}

/// Pressed to the ground by so much, N.
double weight_on(const BeltSupport& support, double mass_kg) {
  return mass_kg * kGravity_m_per_s2 /
         std::sqrt(1.0 + support.forward * support.forward + support.left * support.left);
}

/// What is carried along at this rate, 1/s, from one patch to the next, while it wears off at that
/// one: the rate at which an upwind difference is right in the steady state, a / (exp(a) - 1) of
/// carrying with a = wearing / carrying. By x coth(x) - x with x = a / 2 and the fourth fraction of
/// Lambert's for coth: within 0.005.
BothBelts fitted_rate(const BothBelts& carrying, const BothBelts& wearing) {
  const BothBelts x = 0.5 * wearing / carrying.max(kMinCarrying_per_s);
  const BothBelts q = x.square();
  const BothBelts x_coth = 1.0 + q * (315.0 + 14.0 * q) / (945.0 + q * (105.0 + q));
  return carrying * (x_coth - x).max(0.0);
}

/// Of one place along both belts.
BothBelts both(const std::array<std::array<double, kBeltPatches>, 2>& belts, std::size_t patch) {
  return {belts[0][patch], belts[1][patch]};
}

BothBelts both(const std::array<double, 2>& belts) {
  return {belts[0], belts[1]};
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
  for (std::size_t i = 0; i < kBeltPatches; ++i) {
    patch_m[i] += more.patch_m[i];
    patch_flow_m[i] += more.patch_flow_m[i];
  }
  slid_m += more.slid_m;
  moved_m += more.moved_m;
  return *this;
}

/// matrix * motion = sum, of forward and sideways speed and rate of turn. The matrix is symmetric
/// and positive definite; forward and sideways are not coupled.
struct BeltMotion::System {
  double forward = 0.0;  // of the diagonal
  double left = 0.0;
  double turn = 0.0;
  double forward_turn = 0.0;  // beside it
  double left_turn = 0.0;
  double sum_forward = 0.0;
  double sum_left = 0.0;
  double sum_turn = 0.0;

  void add(double to_forward, double to_left, double to_turn) {
    sum_forward += to_forward;
    sum_left += to_left;
    sum_turn += to_turn;
  }
  /// By elimination of forward and sideways.
  Eigen::Vector3d motion() const {
    const double turn_forward = forward_turn / forward;
    const double turn_left = left_turn / left;
    const double rate = (sum_turn - turn_forward * sum_forward - turn_left * sum_left) /
                        (turn - turn_forward * forward_turn - turn_left * left_turn);
    return {sum_forward / forward - turn_forward * rate, sum_left / left - turn_left * rate, rate};
  }
};

BeltMotion::BeltMotion(const TrackGeometry& tracks, const SoilParameters& soil, const BeltFit& fit)
    : fit_(fit),
      mass_kg_(tracks.mass_kg),
      inertia_kg_m2_(tracks.yaw_inertia_kg_m2),
      middle_(tracks.half_tread_m, -tracks.half_tread_m),
      patch_m_(2.0 * tracks.half_length_m / kBeltPatches),
      cohesion_pa_(soil.cohesion_pa),
      tan_friction_(portable::tan(soil.friction_deg * std::numbers::pi / 180.0)),
      rubber_(tracks.friction),
      per_modulus_(1.0 / soil.shear_modulus_m) {
  for (std::size_t i = 0; i < kBeltPatches; ++i) {
    patches_[i].x = patch_m_ * (0.5 * (kBeltPatches - 1) - static_cast<double>(i));
  }
}

void BeltMotion::set_motion(const FrameMotion& motion, const BeltSupport& support) {
  forward_ = motion.forward_m / kTick_s * along_slope(support.forward);
  left_ = motion.sideways_m / kTick_s * along_slope(support.left);
  turn_ = motion.turn_rad / kTick_s;
}

/// What is mobilised travels with the belt, from its leading end on; the soil ahead is fresh, and a
/// patch that does not touch has nothing.
void BeltMotion::carry(const BeltSupport& support) {
  const BothBelts front = both(support.front);
  const BothBelts rear = both(support.rear);
  // The patch before each one, seen the way the belt goes, is the one to the front of it, or the
  // one to its rear. Beside the ends nothing touches.
  struct Before {
    BothBelts touching_m = BothBelts::Zero();
    BothBelts forward = BothBelts::Zero();
    BothBelts left = BothBelts::Zero();
  };
  std::array<Before, kBeltPatches + 2> before;
  for (std::size_t i = 0; i < kBeltPatches; ++i) {
    Patch& patch = patches_[i];
    patch.touching_m =
        (front.min(patch.x + 0.5 * patch_m_) - rear.max(patch.x - 0.5 * patch_m_)).max(0.0);
    patch.touches = (patch.touching_m / kTouching_m).min(1.0);
    patch.forward *= patch.touches;
    patch.left *= patch.touches;
    before[i + 1] = {patch.touching_m, patch.forward, patch.left};
  }
  const BothBelts speed = speeds_.abs();
  const BothBelts from_front = 0.5 + 0.5 * speeds_ / speed.max(kMinSpeed_m_per_s);
  const BothBelts from_rear = 1.0 - from_front;
  for (std::size_t i = 0; i < kBeltPatches; ++i) {
    Patch& patch = patches_[i];
    const Before& to_front = before[i];
    const Before& to_rear = before[i + 2];
    // From the middle of what touches of the patch before, or from where contact begins.
    const BothBelts touching_before =
        from_front * to_front.touching_m + from_rear * to_rear.touching_m;
    const BothBelts way = (0.5 * (touching_before + patch.touching_m)).max(kMinContact_m);
    const BothBelts share =
        (kTick_s * fitted_rate(speed / way, patch.slip * per_modulus_)).min(1.0) * patch.touches;
    patch.forward +=
        share * (from_front * to_front.forward + from_rear * to_rear.forward - patch.forward);
    patch.left += share * (from_front * to_front.left + from_rear * to_rear.left - patch.left);
  }
}

/// Both belts' force at the end of the frame: strength kept (m + dt slip' / K), where slip' is what
/// the motion at the end makes it, and rolling. How much of m is kept, and where rolling acts,
/// comes from `motion`.
void BeltMotion::shear(const BeltSupport& support, const Eigen::Vector3d& motion, System& system) {
  const double weight = weight_on(support, mass_kg_);
  const BothBelts travel = motion[0] - motion[2] * middle_;  // of the robot at each belt, m/s
  const BothBelts along_slip = speeds_ - travel;
  const BothBelts filled = both(support.filled);
  BothBelts load = BothBelts::Zero();
  BothBelts forward = BothBelts::Zero();  // forces times the frame
  BothBelts stiffness = BothBelts::Zero();
  for (std::size_t i = 0; i < kBeltPatches; ++i) {
    Patch& patch = patches_[i];
    const BothBelts carries = weight * both(support.load, i);
    load += carries;
    const BothBelts cohesion = cohesion_pa_ * both(support.area, i);
    patch.strength =
        (cohesion + carries * tan_friction_)
            .min(filled * cohesion + carries * (filled * tan_friction_ + (1.0 - filled) * rubber_));
    const double across_slip = motion[1] + motion[2] * patch.x;
    patch.slip = (along_slip.square() + across_slip * across_slip).sqrt();
    patch.kept = 1.0 / (1.0 + kTick_s * per_modulus_ * patch.slip);
    const BothBelts per_slip = patch.kept * per_modulus_;
    const BothBelts along = kTick_s * patch.strength;
    const BothBelts across = fit_.sideways * along;
    const BothBelts k = kTick_s * along * per_slip;
    forward += along * patch.kept * patch.forward + k * speeds_;
    stiffness += k;
    const double left = (across * patch.kept * patch.left).sum();
    const double ks = (kTick_s * across * per_slip).sum();
    system.add(0.0, left, left * patch.x);
    system.left += ks;
    system.left_turn += ks * patch.x;
    system.turn += ks * patch.x * patch.x;
  }
  forward -= kTick_s * fit_.rolling * load * (travel / kRollingSpeed_m_per_s).max(-1.0).min(1.0);
  system.add(forward.sum(), 0.0, -(forward * middle_).sum());
  system.forward += stiffness.sum();
  system.forward_turn -= (stiffness * middle_).sum();
  system.turn += (stiffness * middle_.square()).sum();
}

/// What the motion at the end of the frame has mobilised.
void BeltMotion::finish() {
  const BothBelts along = kTick_s * (speeds_ - forward_ + turn_ * middle_);
  BothBelts traction = BothBelts::Zero();
  for (Patch& patch : patches_) {
    patch.forward = patch.kept * (patch.forward + per_modulus_ * along);
    patch.left = patch.kept * (patch.left - per_modulus_ * kTick_s * (left_ + turn_ * patch.x));
    traction += patch.strength * patch.forward;
  }
  traction_n_ = {traction[0], traction[1]};
}

std::array<BeltShear, 2> BeltMotion::shear() const {
  const BothBelts along = kTick_s * (speeds_ - forward_ + turn_ * middle_);
  const BothBelts slid = along.abs();
  const BothBelts moved = kTick_s * speeds_.abs().max((forward_ - turn_ * middle_).abs());
  std::array<BeltShear, 2> belts;
  for (std::size_t i = 0; i < kBeltPatches; ++i) {
    const Patch& patch = patches_[i];
    const double across = -kTick_s * (left_ + turn_ * patch.x);
    const BothBelts mobilised = (patch.forward.square() + patch.left.square()).sqrt();
    const BothBelts length = mobilised * (along.square() + across * across).sqrt();
    for (const Eigen::Index side : {0, 1}) {
      BeltShear& belt = belts[static_cast<std::size_t>(side)];
      belt.patch_m[i] = length[side];
      belt.patch_flow_m[i] = slip_flow(mobilised[side], length[side] / kTick_s) * kTick_s;
      belt.forward_m += mobilised[side] * along[side] / kBeltPatches;
      belt.left_m += mobilised[side] * across / kBeltPatches;
      belt.length_m += length[side] / kBeltPatches;
      belt.slid_m = slid[side];
      belt.moved_m = moved[side];
    }
  }
  return belts;
}

FrameMotion BeltMotion::step(double left_m_per_s, double right_m_per_s, const BeltSupport& support,
                             const Eigen::Vector3d& push) {
  speeds_ = {left_m_per_s, right_m_per_s};
  System system;
  system.forward = system.left = mass_kg_;
  system.turn = inertia_kg_m2_;
  // The body turns, its axes with it.
  system.add(mass_kg_ * (forward_ + kTick_s * turn_ * left_),
             mass_kg_ * (left_ - kTick_s * turn_ * forward_), inertia_kg_m2_ * turn_);
  const double downhill = kTick_s * weight_on(support, mass_kg_);
  system.add(-downhill * support.forward, -downhill * support.left, 0.0);
  system.add(kTick_s * push[0], kTick_s * push[1], kTick_s * push[2]);
  carry(support);
  Eigen::Vector3d motion(forward_, left_, turn_);
  for (int pass = 0; pass < kPasses; ++pass) {
    System with_shear = system;
    shear(support, motion, with_shear);
    motion = with_shear.motion();
  }
  forward_ = motion[0];
  left_ = motion[1];
  turn_ = motion[2];
  finish();
  return {kTick_s * forward_ / along_slope(support.forward),
          kTick_s * left_ / along_slope(support.left), kTick_s * turn_};
}

void BeltMotion::follow(double left_m_per_s, double right_m_per_s, const BeltSupport& support,
                        const FrameMotion& motion) {
  speeds_ = {left_m_per_s, right_m_per_s};
  System unused;
  set_motion(motion, support);
  carry(support);
  shear(support, {forward_, left_, turn_}, unused);
  finish();
}

}  // namespace screed
