// Solution of three equations in one order of operations. Eigen's own adds in an order that its
// version and the processor choose.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace screed {

/// x of a x = b by Cholesky's decomposition; `a`: symmetric and positive definite, else x is not
/// finite or without meaning. Only its lower half is read.
inline Eigen::Vector3d solve_positive(const Eigen::Matrix3d& a, const Eigen::Vector3d& b) {
  const double l00 = std::sqrt(a(0, 0));
  const double l10 = a(1, 0) / l00;
  const double l20 = a(2, 0) / l00;
  const double l11 = std::sqrt(a(1, 1) - l10 * l10);
  const double l21 = (a(2, 1) - l20 * l10) / l11;
  const double l22 = std::sqrt(a(2, 2) - (l20 * l20 + l21 * l21));
  const double y0 = b(0) / l00;
  const double y1 = (b(1) - l10 * y0) / l11;
  const double y2 = (b(2) - (l20 * y0 + l21 * y1)) / l22;
  const double x2 = y2 / l22;
  const double x1 = (y1 - l21 * x2) / l11;
  const double x0 = (y0 - (l10 * x1 + l20 * x2)) / l00;
  return {x0, x1, x2};
}

}  // namespace screed
