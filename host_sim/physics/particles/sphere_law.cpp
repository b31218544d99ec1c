// The law of contacts for one contact, in double precision; its constants from the material.
#include "host_sim/physics/particles/sphere_law.h"

#include <algorithm>
#include <cmath>

namespace screed {
namespace {

constexpr double kShearShare = 0.5;  // of the normal spring and damper
constexpr double kRollDampingRatio = 0.3;

#define SCREED_LAW_TARGET
using Number = double;

#include "host_sim/physics/particles/contact_alone.inc"
#include "host_sim/physics/particles/contact_law.inc"

Three three(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}
Three three(const float* v) {
  return {v[0], v[1], v[2]};
}
void store(const Three& from, float* v) {
  v[0] = static_cast<float>(from.x);
  v[1] = static_cast<float>(from.y);
  v[2] = static_cast<float>(from.z);
}

double square(double a) {
  return a * a;
}

LawConstants<double> constants_of(const ParticleMaterial& material) {
  LawConstants<double> law{};
  law.stiffness = material.stiffness_n_per_m();
  law.damping = 2.0 * material.damping_ratio * std::sqrt(law.stiffness * 0.5 * material.mass_kg());
  law.shear_stiffness = kShearShare * law.stiffness;
  law.shear_damping = kShearShare * law.damping;
  law.shear_flex = 1.0 / law.shear_stiffness;
  law.roll_arm = material.rolling * material.radius_m;
  law.roll_stiffness =
      2.25 * law.stiffness * square(std::min(law.roll_arm, 0.5 * material.radius_m));
  law.roll_damping =
      2.0 * kRollDampingRatio * std::sqrt(law.roll_stiffness * 0.5 * material.inertia_kg_m2());
  law.roll_flex = law.roll_stiffness > 0.0 ? 1.0 / law.roll_stiffness : 0.0;
  return law;
}

}  // namespace

SphereLaw::SphereLaw(const ParticleMaterial& material) : law_(constants_of(material)) {}

SphereForce SphereLaw::force(const SphereContact& contact, double friction, double dt,
                             ContactBristle& bristle) const {
  LawState state{three(bristle.slide), three(bristle.roll)};
  const LawPush push = contact_push(law_,
                                    {three(contact.normal), contact.overlap,
                                     three(contact.velocity), three(contact.angular_velocity)},
                                    friction, dt, state);
  store(state.slide, bristle.slide);
  store(state.roll, bristle.roll);
  return {{push.force.x, push.force.y, push.force.z},
          {push.moment.x, push.moment.y, push.moment.z}};
}

LawConstants<float> SphereLaw::single_precision() const {
  const auto single = [](double a) { return static_cast<float>(a); };
  return {single(law_.stiffness),     single(law_.damping),    single(law_.shear_stiffness),
          single(law_.shear_damping), single(law_.shear_flex), single(law_.roll_stiffness),
          single(law_.roll_damping),  single(law_.roll_flex),  single(law_.roll_arm)};
}

}  // namespace screed
