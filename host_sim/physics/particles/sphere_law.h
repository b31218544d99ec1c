// How equal spheres push on each other, on walls and on what drives over them: a spring and damper
// that never pull, elastic bristles with Coulomb's limit, and elastic resistance to rolling with a
// limit of its own. The bristles remember, so that a pile stands still instead of creeping.
//
// Normal and sliding part: Cundall and Strack 1979. Rolling part: the elastic-plastic spring and
// dashpot of Ai et al. 2011 (model C), with the stiffness of Iwashita and Oda 1998 for moments up
// to half the radius times the force: stiffer, light spheres would need shorter steps.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>

#include "host_sim/physics/particles/contact_law.h"

namespace screed {

/// What the particles are made of.
struct ParticleMaterial {
  double radius_m = 0.0125;
  double density_kg_per_m3 = 2600.0;  ///< of a grain: quartz
  double friction = 0.6;              ///< Coulomb coefficient between particles, and on the walls
  double rolling = 0.1;  ///< rolling moment's limit over normal force and radius: rounded gravel
  double stiffness_pa = 4.0e5;  ///< normal stiffness over radius; far softer than stone (see docs)
  double damping_ratio = 0.4;   ///< of the normal spring between two particles: restitution 0.36

  double mass_kg() const {
    return 4.0 / 3.0 * std::numbers::pi * radius_m * radius_m * radius_m * density_kg_per_m3;
  }
  double inertia_kg_m2() const { return 0.4 * mass_kg() * radius_m * radius_m; }
  double stiffness_n_per_m() const { return stiffness_pa * radius_m; }
};

/// One contact between a particle and a partner, as the law sees it.
struct SphereContact {
  Eigen::Vector3d normal;            ///< from the partner to the particle, unit length
  double overlap;                    ///< m, positive
  Eigen::Vector3d velocity;          ///< of the particle's surface relative to the partner's, m/s
  Eigen::Vector3d angular_velocity;  ///< of the particle relative to the partner, rad/s
};

/// Force at the contact and moment on the particle; the partner gets the opposite.
struct SphereForce {
  Eigen::Vector3d force;
  Eigen::Vector3d moment;
};

class SphereLaw {
 public:
  explicit SphereLaw(const ParticleMaterial& material);

  /// A quarter of sqrt(m / k): the stiffest mode of a sphere with twelve neighbours still has more
  /// than four steps a radian.
  static double longest_step_s(const ParticleMaterial& material) {
    return 0.25 * std::sqrt(material.mass_kg() / material.stiffness_n_per_m());
  }

  /// The force of a single contact, in double precision.
  SphereForce force(const SphereContact& contact, double friction, double dt,
                    ContactBristle& bristle) const;
  /// The law for those who compute many contacts at once.
  LawConstants<float> single_precision() const;

 private:
  LawConstants<double> law_;
};

}  // namespace screed
