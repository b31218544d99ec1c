// What the stand-in's closed forms do not say by themselves: four numbers, the same for all soils,
// chosen on drives in the physics (docs/standin.md).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "host_sim/physics/soil/soil_parameters.h"
#include "host_sim/standin/planar_pose.h"

namespace screed {

struct BeltFit {
  /// Strength across a belt over that along it.
  double sideways = 2.0;
  /// Resistance to rolling over load.
  double rolling = 0.02;
  /// Stiffness of unloading, over the soil's mean stiffness at 2 kPa, where the soil's own E is
  /// more: so that one compacted cell does not hold a belt up.
  double unloading = 10.0;
  /// Of the volume that slip digs, over that of the soil's law.
  double digging = 1.15;
};

// How a robot on two belts moves over soil, in closed form: a planar body, and soil that shears
// below its belts.
//
// Each belt is three patches, one behind the other. m is the share of its strength that the soil
// below a patch has mobilised, forward and to the left; it is carried backward with the belt and
// wears off with the way slid, so that it is Janosi and Hanamoto's 1 - exp(-j / K) while a belt
// slips in one direction, and right at reversals as well (shear_field.h):
//   dm/dt = (slip - |slip| m) / K - |belt| dm/dx
// along the belt by exponential fitting, which is exact where it slips evenly (D. L. Scharfetter,
// H. K. Gummel, IEEE Transactions on Electron Devices 16, 1969; here within 0.005), and with
//   slip  = velocity of the belt's surface, seen from the ground, backward and to the right
//   force = (c A + W tan phi) m,  across the belt times BeltFit::sideways
// where the belt's tread has sunk in; where it has not, rubber holds without cohesion.
// Gravity pulls down the slope, rolling resists. A frame is one implicit step, stable however stiff
// the soil is. A belt that stands shears until it holds, and then stays: what is not driven and not
// on too steep a slope stands for ever.
// Not modelled: soil pushed ahead and aside by its density, a chassis that touches the ground.

inline constexpr std::size_t kBeltPatches = 3;  // of a belt, from the front to the rear

/// A number of the left belt and one of the right: the processor computes both at once.
using BothBelts = Eigen::Array2d;

/// How a robot stands: slopes of the plane of its belts (rise over run, nose and left side up), and
/// what each patch carries and touches, left belt first.
struct BeltSupport {
  double forward = 0.0;
  double left = 0.0;
  std::array<std::array<double, kBeltPatches>, 2> load{};  ///< shares of the weight, 1 in all
  std::array<std::array<double, kBeltPatches>, 2> area{};  ///< m^2 that touch
  /// Between what of a belt touches first and last, from the robot's middle, m.
  std::array<double, 2> front{};
  std::array<double, 2> rear{};
  /// As much of the tread's height as the belt has sunk, 0..1; 1 where there is no tread.
  std::array<double, 2> filled{1.0, 1.0};
};
/// On level, even ground.
BeltSupport level_support(const TrackGeometry& tracks);

/// What a belt has done to the soil below it: its slip times what was mobilised, mean over its
/// patches, as the way that the robot gained by it, m; and the way of both surfaces over the other.
struct BeltShear {
  double forward_m = 0.0;
  double left_m = 0.0;
  double length_m = 0.0;  ///< of the same, whatever its direction
  /// The same of each patch: the mean is length_m.
  std::array<double, kBeltPatches> patch_m{};
  std::array<double, kBeltPatches> patch_flow_m{};  ///< slip_flow() of each patch
  double slid_m = 0.0;                              ///< along the belt, not weighted
  double moved_m = 0.0;                             ///< of belt or ground, whichever moved more

  BeltShear& operator+=(const BeltShear& more);
};

class BeltMotion {
 public:
  BeltMotion(const TrackGeometry& tracks, const SoilParameters& soil, const BeltFit& fit = {});

  /// One frame with these speeds of the belts' surfaces, m/s. `push`: force forward and to the left
  /// and torque of something else, N, N, N m.
  FrameMotion step(double left_m_per_s, double right_m_per_s, const BeltSupport& support,
                   const Eigen::Vector3d& push = Eigen::Vector3d::Zero());

  /// The same where something else moves the robot, this far in the frame: what its belts do to
  /// the soil.
  void follow(double left_m_per_s, double right_m_per_s, const BeltSupport& support,
              const FrameMotion& motion);

  /// Of the last frame, left and right. Computed here, for grounds that are dug.
  std::array<BeltShear, 2> shear() const;
  /// Forward on each belt in the last frame, N: what its shaft feels.
  const std::array<double, 2>& traction_n() const { return traction_n_; }

  /// What the last frame's motion was, when something else says so.
  void set_motion(const FrameMotion& motion, const BeltSupport& support);

 private:
  struct Patch {                               // the same place along both belts
    double x = 0.0;                            // of its middle, from the robot's, m
    BothBelts touching_m = BothBelts::Zero();  // of its length, from what touches first to last
    BothBelts touches = BothBelts::Zero();     // 1, or 0 where nothing does
    BothBelts forward = BothBelts::Zero();     // mobilised
    BothBelts left = BothBelts::Zero();
    BothBelts slip = BothBelts::Zero();      // in the last frame, m/s
    BothBelts strength = BothBelts::Zero();  // in this frame, N
    BothBelts kept = BothBelts::Zero();      // share of what was mobilised before
  };
  struct System;

  void carry(const BeltSupport& support);
  void shear(const BeltSupport& support, const Eigen::Vector3d& motion, System& system);
  void finish();

  BeltFit fit_;
  double mass_kg_;
  double inertia_kg_m2_;
  BothBelts middle_;  // to the left of the robot's, m
  double patch_m_;    // length of a patch
  double cohesion_pa_;
  double tan_friction_;
  double rubber_;  // its friction
  double per_modulus_;
  double forward_ = 0.0;  // along the slope, m/s
  double left_ = 0.0;
  double turn_ = 0.0;                     // rad/s
  BothBelts speeds_ = BothBelts::Zero();  // of the belts' surfaces, m/s
  std::array<Patch, kBeltPatches> patches_{};
  std::array<double, 2> traction_n_{};
};

}  // namespace screed
