// How equal spheres push on each other, on walls and on what drives over them: a spring and damper
// that never pull, elastic bristles with Coulomb's limit, and elastic resistance to rolling with a
// limit of its own. The bristles remember, so that a pile stands still instead of creeping.
//
// Normal and sliding part: Cundall and Strack 1979. Rolling part: the elastic-plastic spring and
// dashpot of Ai et al. 2011 (model C), with the stiffness of Iwashita and Oda 1998 for moments up
// to half the radius times the force: stiffer, light spheres would need shorter steps.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

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

/// State of a contact: how far the surfaces have moved (m) and turned (rad) over each other
/// while they stuck.
struct ContactBristle {
  float slide[3];
  float roll[3];
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
  explicit SphereLaw(const ParticleMaterial& material)
      : stiffness_(material.stiffness_n_per_m()),
        rolling_arm_(material.rolling * material.radius_m),
        roll_stiffness_(2.25 * stiffness_ *
                        square(std::min(rolling_arm_, 0.5 * material.radius_m))),
        roll_damping_(2.0 * kRollDampingRatio *
                      std::sqrt(roll_stiffness_ * 0.5 * material.inertia_kg_m2())),
        damping_(2.0 * material.damping_ratio * std::sqrt(stiffness_ * 0.5 * material.mass_kg())) {}

  /// A quarter of sqrt(m / k): the stiffest mode of a sphere with twelve neighbours still has more
  /// than four steps a radian.
  static double longest_step_s(const ParticleMaterial& material) {
    return 0.25 * std::sqrt(material.mass_kg() / material.stiffness_n_per_m());
  }

  SphereForce force(const SphereContact& contact, double friction, double dt,
                    ContactBristle& bristle) const {
    const double normal_speed = contact.velocity.dot(contact.normal);
    const double normal_force = stiffness_ * contact.overlap - damping_ * normal_speed;
    if (normal_force <= 0.0) {
      bristle = {};
      return {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
    }
    const Eigen::Vector3d sliding = contact.velocity - normal_speed * contact.normal;
    Eigen::Vector3d bent = load(bristle.slide) + sliding * dt;
    bent -= bent.dot(contact.normal) * contact.normal;
    Eigen::Vector3d tangential = -kShearShare * (stiffness_ * bent + damping_ * sliding);
    if (limit(tangential, friction * normal_force)) bent = tangential / (-kShearShare * stiffness_);
    store(bent, bristle.slide);

    Eigen::Vector3d moment = Eigen::Vector3d::Zero();
    if (rolling_arm_ > 0.0) {
      Eigen::Vector3d turned = load(bristle.roll) + contact.angular_velocity * dt;
      moment = -roll_stiffness_ * turned - roll_damping_ * contact.angular_velocity;
      if (limit(moment, rolling_arm_ * normal_force)) turned = moment / -roll_stiffness_;
      store(turned, bristle.roll);
    }
    return {normal_force * contact.normal + tangential, moment};
  }

 private:
  static constexpr double kShearShare = 0.5;  // of the normal spring and damper
  static constexpr double kRollDampingRatio = 0.3;

  static double square(double a) { return a * a; }
  static Eigen::Vector3d load(const float* v) {
    return Eigen::Map<const Eigen::Vector3f>(v).cast<double>();
  }
  static void store(const Eigen::Vector3d& from, float* v) {
    for (int i = 0; i < 3; ++i) v[i] = static_cast<float>(from[i]);
  }
  static bool limit(Eigen::Vector3d& v, double max_length) {
    const double square = v.squaredNorm();
    if (square <= max_length * max_length) return false;
    v *= max_length / std::sqrt(square);
    return true;
  }

  double stiffness_;       // N/m
  double rolling_arm_;     // m
  double roll_stiffness_;  // N m / rad
  double roll_damping_;    // N m s / rad
  double damping_;         // N s/m
};

}  // namespace screed
