// Vectors for kernels, and back. Apart from kernels.h, since kernels may not see Eigen's templates.
#pragma once

#include <Eigen/Core>

#include "host_sim/physics/kernels/kernels.h"

namespace screed {

inline Triple triple(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}
inline Eigen::Vector3d vector(const Triple& t) {
  return {t.x, t.y, t.z};
}

}  // namespace screed
