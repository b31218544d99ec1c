// The linear system of a closed chain: every pin has two unknowns and is coupled with its two
// neighbours.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace screed {

/// Solves A x = b, A symmetric and positive definite, in blocks of 2 x 2: block i of the diagonal
/// is diagonal[i], the block in row i and column i + 1 is next[i]; the last one couples the last
/// pin with the first. By elimination, in time proportional to the number of pins (three or more);
/// allocates nothing.
class ChainSolver {
 public:
  explicit ChainSolver(size_t pins);

  std::vector<Eigen::Matrix2d> diagonal;
  std::vector<Eigen::Matrix2d> next;
  std::vector<Eigen::Vector2d> right;

  /// Uses up diagonal and right. The result is valid until the next call.
  const std::vector<Eigen::Vector2d>& solve();

 private:
  std::vector<Eigen::Matrix2d> to_last_;  // what is left of each row's coupling with the last pin
  std::vector<Eigen::Vector2d> x_;
};

}  // namespace screed
