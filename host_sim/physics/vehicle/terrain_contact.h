// The force between one point of a surface that may move (a belt, a wheel's rim, the chassis) and
// rigid terrain.
//
// Normal: a spring and damper that never pull. Tangential: elastic bristles with Coulomb's limit:
// the bristle is the distance that the surface has moved over the terrain while it stuck, so a
// robot stands still on a slope instead of creeping. Along a moving belt the bristles travel with
// its material (brush model; Pacejka, Tire and Vehicle Dynamics, ch. 3): the owner of the points
// does that.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "host_sim/physics/terrain/height_field.h"

namespace screed {

struct ContactLaw {
  double stiffness = 0.0;  ///< N/m per point, normal and tangential alike
  double damping = 0.0;    ///< N s/m per point
  double friction = 0.8;   ///< Coulomb coefficient
};

/// How the terrain lies under a point that is in it.
struct TerrainContact {
  Eigen::Vector3d normal;  ///< of the terrain, unit length
  double depth;            ///< m, along the normal, positive
};

/// Whether `position` is below the terrain's surface.
inline bool find_contact(const HeightField& terrain, const Eigen::Vector3d& position,
                         TerrainContact& contact) {
  const SurfacePoint surface = terrain.at(position.x(), position.y());
  const double gap = position.z() - surface.height;
  if (gap >= 0.0) return false;
  const double scale = 1.0 / std::sqrt(1.0 + surface.gradient_x * surface.gradient_x +
                                       surface.gradient_y * surface.gradient_y);
  contact.normal = {-surface.gradient_x * scale, -surface.gradient_y * scale, scale};
  contact.depth = -gap * scale;
  return true;
}

/// Force on a surface point that touches the terrain. The surface moves at `velocity` over it, belt
/// motion included; the contact point sinks in at `body_velocity`, without it: a wheel that
/// rolls does not press deeper where its rim goes down. `bristle` is the state of the point, world
/// frame, m; it becomes zero when the point is being pulled out and carries no load.
inline Eigen::Vector3d contact_force(const ContactLaw& law, const TerrainContact& contact,
                                     const Eigen::Vector3d& body_velocity,
                                     const Eigen::Vector3d& velocity, double dt,
                                     Eigen::Vector3d& bristle) {
  const double normal_force =
      law.stiffness * contact.depth - law.damping * body_velocity.dot(contact.normal);
  if (normal_force <= 0.0) {
    bristle.setZero();
    return Eigen::Vector3d::Zero();
  }
  const Eigen::Vector3d sliding = velocity - velocity.dot(contact.normal) * contact.normal;
  bristle += sliding * dt;
  bristle -= bristle.dot(contact.normal) * contact.normal;
  Eigen::Vector3d tangential = -law.stiffness * bristle - law.damping * sliding;
  const double limit = law.friction * normal_force;
  const double size2 = tangential.squaredNorm();
  if (size2 > limit * limit) {
    tangential *= limit / std::sqrt(size2);
    bristle = tangential / -law.stiffness;
  }
  return normal_force * contact.normal + tangential;
}

}  // namespace screed
