// Ownership of an ODE world, and conversions between ODE's types and Eigen's.
#pragma once

#include <ode/ode.h>

#include <Eigen/Geometry>

namespace screed {

/// An ODE world with gravity. ODE keeps global state (memory, dRandSetSeed): nothing here uses its
/// random numbers. Worlds of different threads may step at the same time.
class OdeWorld {
 public:
  OdeWorld();
  ~OdeWorld();
  OdeWorld(const OdeWorld&) = delete;
  OdeWorld& operator=(const OdeWorld&) = delete;

  dWorldID id() const { return world_; }
  /// Integrates all bodies over dt seconds with the forces that were added since the last step.
  void step(double dt) { dWorldStep(world_, dt); }

 private:
  dWorldID world_;
  dThreadingImplementationID threading_;
};

inline Eigen::Vector3d to_eigen(const dReal* v) {
  return {v[0], v[1], v[2]};
}
inline Eigen::Matrix3d rotation_to_eigen(const dReal* r) {  // ODE's matrices have rows of four
  Eigen::Matrix3d m;
  m << r[0], r[1], r[2], r[4], r[5], r[6], r[8], r[9], r[10];
  return m;
}
inline void to_ode(const Eigen::Matrix3d& m, dMatrix3 r) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) r[4 * row + column] = m(row, column);
    r[4 * row + 3] = 0.0;
  }
}

}  // namespace screed
