// Block elimination of a cyclic tridiagonal system: the last pin is the border of the others.
#include "host_sim/physics/vehicle/chain_solver.h"

#include <Eigen/LU>

namespace screed {

ChainSolver::ChainSolver(size_t pins)
    : diagonal(pins), next(pins), right(pins), to_last_(pins), x_(pins) {}

const std::vector<Eigen::Vector2d>& ChainSolver::solve() {
  const size_t last = diagonal.size() - 1;
  for (size_t i = 0; i < last; ++i) to_last_[i].setZero();
  to_last_[0] = next[last].transpose();
  to_last_[last - 1] += next[last - 1];

  // Forwards: what is below the diagonal goes, row by row; the last row is kept up to date.
  for (size_t i = 0; i < last; ++i) {
    const Eigen::Matrix2d inverse = diagonal[i].inverse();
    const Eigen::Matrix2d onto_last = to_last_[i].transpose() * inverse;
    diagonal[last] -= onto_last * to_last_[i];
    right[last] -= onto_last * right[i];
    if (i + 1 < last) {
      const Eigen::Matrix2d onto_next = next[i].transpose() * inverse;
      diagonal[i + 1] -= onto_next * next[i];
      to_last_[i + 1] -= onto_next * to_last_[i];
      right[i + 1] -= onto_next * right[i];
    }
    diagonal[i] = inverse;
  }
  // Backwards.
  x_[last] = diagonal[last].inverse() * right[last];
  for (size_t i = last; i-- > 0;) {
    Eigen::Vector2d residual = right[i] - to_last_[i] * x_[last];
    if (i + 1 < last) residual -= next[i] * x_[i + 1];
    x_[i] = diagonal[i] * residual;
  }
  return x_;
}

}  // namespace screed
