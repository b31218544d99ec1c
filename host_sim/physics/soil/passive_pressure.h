// Resistance of soil that a body pushes ahead of it or aside: the passive earth pressure on a
// vertical face (M. G. Bekker, Introduction to Terrain-Vehicle Systems, 1969; I. Hegedus, A
// simplified method for the determination of bulldozing resistance, Land Locomotion Laboratory
// report 61, 1960; for wheels G. Ishigami et al., Journal of Field Robotics 24(3), 2007).
//
//   X    = 45 degrees - phi / 2                            inclination of the sliding plane
//   D1   = cot X + tan(X + phi)
//   D2   = cot X + cot^2 X tan phi
//   R(z) = D1 (c z + 1/2 gamma z^2 D2)                     N per metre of width, of a face z deep
#pragma once

#include <cmath>
#include <numbers>

#include "host_sim/core/elementary.h"
#include "host_sim/core/gravity.h"
#include "host_sim/physics/soil/soil_parameters.h"

namespace screed {

class PassivePressure {
 public:
  /// None where the soil's density is 0: not known.
  explicit PassivePressure(const SoilParameters& soil) {
    if (soil.density_kg_per_m3 <= 0.0) return;
    const double friction = soil.friction_deg * std::numbers::pi / 180.0;
    const double plane = 0.25 * std::numbers::pi - 0.5 * friction;
    const double cot = 1.0 / portable::tan(plane);
    const double d1 = cot + portable::tan(plane + friction);
    const double d2 = cot + cot * cot * portable::tan(friction);
    at_surface_ = d1 * soil.cohesion_pa;
    per_depth_ = d1 * d2 * soil.density_kg_per_m3 * kGravity_m_per_s2;
  }
  /// On the face, at a depth, Pa.
  double pressure(double depth_m) const { return at_surface_ + per_depth_ * depth_m; }
  /// On all of a face as deep as this, N/m.
  double resistance(double depth_m) const {
    return depth_m * (at_surface_ + 0.5 * per_depth_ * depth_m);
  }
  /// pressure() at the surface, Pa, and its growth with depth, Pa/m.
  double at_surface_pa() const { return at_surface_; }
  double per_depth_pa_per_m() const { return per_depth_; }
  bool none() const { return per_depth_ == 0.0; }

 private:
  double at_surface_ = 0.0;
  double per_depth_ = 0.0;
};

}  // namespace screed
