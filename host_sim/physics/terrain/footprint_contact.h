// Contact of a body with terrain by its footprints: the body's state, the terrain's reaction, and
// what is kept between steps.
#pragma once

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

#include "host_sim/physics/terrain/footprint.h"
#include "host_sim/physics/terrain/shear_field.h"

namespace screed {

/// Motion of the pressing surface: that of the body plus the speed of its belt or rim. Particles
/// use all but `slip` and `mass_kg`. Soil takes the body's motion from PressingBody, and from here
/// `surface_speed` and `slip`; only SoilBed::press() of a single footprint uses the rest.
struct FootprintMotion {
  /// Of the footprint's centre, world frame, m/s.
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  /// Of the body without the wheel's spin, rad/s.
  Eigen::Vector3d omega = Eigen::Vector3d::Zero();
  /// Of the belt over its wheels, forward drive positive: then the lower run goes backward, m/s.
  double surface_speed = 0.0;
  /// (surface_speed - ground speed) / the larger of both magnitudes, in the direction of travel:
  /// -1..1, positive driven, negative braked.
  double slip = 0.0;
  /// Coulomb's, against solid elements.
  double friction = 0.8;
  /// Against soil: tangent of the angle of friction. Infinite: rough, soil shears on soil.
  double soil_friction = std::numeric_limits<double>::infinity();
  double adhesion_pa = 0.0;   ///< of soil to the surface
  double lug_height_m = 0.0;  ///< of what holds soil and takes it along
  /// That the footprint carries; infinite: the motion is imposed, whatever the force.
  double mass_kg = 1.0;
};

/// Slip of a surface that moves at `surface_speed` over its wheels while they go at `ground_speed`:
/// the difference over the larger of both magnitudes, -1..1, positive when it drives, negative when
/// it brakes. 0 where both are below 1 mm/s: slip means nothing there.
inline double signed_slip(double surface_speed, double ground_speed) {
  constexpr double kSlipSpeed = 1e-3;
  const double faster = std::max(std::abs(surface_speed), std::abs(ground_speed));
  if (faster <= kSlipSpeed) return 0.0;
  if (surface_speed * ground_speed < 0.0) return 1.0;
  return (std::abs(surface_speed) - std::abs(ground_speed)) / faster;
}

/// Force and torque on the footprint, world frame, torque about its centre; what drives it; what it
/// rests on.
struct TerrainReaction {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();
  /// Force along the motion that the belt's surface has when driving ahead (backward on its lower
  /// run), N: negative while the terrain holds the belt back.
  double along_surface = 0.0;
  double normal_load = 0.0;  ///< vertical part of the normal forces, N
  double sinkage = 0.0;      ///< greatest depth below the reference level, m
  double area = 0.0;         ///< touched, projected to the horizontal, m^2
};

/// What a body remembers from step to step. Three components: up, roll about the world's x, pitch
/// about its y.
struct BodyMemory {
  bool touching = false;
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();  ///< m/s, rad/s
  /// What the soil's pressure added to the rate, m/s^2, rad/s^2.
  Eigen::Vector3d soil_acceleration = Eigen::Vector3d::Zero();
  template <typename Archive>
  void serialize(Archive& archive) {
    archive(touching);
    for (Eigen::Vector3d* it : {&rate, &soil_acceleration}) archive(it->x(), it->y(), it->z());
  }
};

/// What a footprint remembers from step to step.
struct ContactMemory {
  double patch_b_m = 0.0;  ///< b of Bekker's formula, from the touched area
  double patch_area_m2 = 0.0;
  double sinkage = 0.0;  ///< greatest depth in the last step, m
  double depth = 0.0;    ///< mean depth in the last step, m; of surfaces that dig
  double slip = 0.0;     ///< mean over the length of the contact
  ShearField shear;      ///< along the running surface
  ShearField side;       ///< of the soil beside it, for what is pushed aside
  int face = -1;         ///< of the footprint that is below
  PathHistory path;      ///< since contact began or the body turned back; its gradient is recent
  BodyMemory alone;      ///< of a footprint that is pressed by itself

  /// The footprint is in the air. Keeps room.
  void leave() {
    patch_b_m = patch_area_m2 = sinkage = depth = slip = 0.0;
    path = {};
    alone = {};
  }
  template <typename Archive>
  void serialize(Archive& archive) {
    archive(patch_b_m, patch_area_m2, sinkage, depth, slip, shear, side, face, path, alone);
  }
};

/// A rigid body that stands on terrain with one footprint or several, in one step.
struct PressingBody {
  double mass_kg = 1.0;  ///< infinite: the motion is imposed
  /// About `centre`, world axes; zero: the soil does not tilt the body.
  Eigen::Matrix3d inverse_inertia = Eigen::Matrix3d::Zero();
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();    ///< of mass, world frame, m
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< of it, m/s
  Eigen::Vector3d omega = Eigen::Vector3d::Zero();     ///< rad/s
};

/// One footprint of such a body; the reaction is the answer.
struct FootprintContact {
  const Footprint* footprint = nullptr;  ///< known by its address, which must not change
  ContactMemory* memory = nullptr;       ///< null where the terrain keeps nothing by footprint
  FootprintMotion motion = {};
  /// In and out: from the body's centre to the footprint's, world frame, m. SoilBed::press()
  /// replaces it by the difference of the two positions, which differs by rounding: sums of torque
  /// use it after press() only.
  Eigen::Vector3d arm = Eigen::Vector3d::Zero();
  TerrainReaction reaction = {};
};

}  // namespace screed
