// The cyclic block elimination against Eigen's dense solver.
#include "host_sim/physics/vehicle/chain_solver.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "host_sim/core/random.h"

namespace screed {
namespace {

TEST(ChainSolver, AgreesWithADenseSolver) {
  WorldRandom random(7, "chain");
  const auto number = [&] { return random.uniform(-0.5, 0.5); };
  for (const int pins : {3, 4, 5, 54}) {
    const auto size = static_cast<size_t>(pins);
    ChainSolver solver(size);
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(2 * pins, 2 * pins);
    Eigen::VectorXd right(2 * pins);
    for (int i = 0; i < pins; ++i) {
      const int j = (i + 1) % pins;
      Eigen::Matrix2d link;
      link << number(), number(), number(), number();
      solver.next[static_cast<size_t>(i)] = link;
      dense.block<2, 2>(2 * i, 2 * j) += link;
      dense.block<2, 2>(2 * j, 2 * i) += link.transpose();
      Eigen::Matrix2d own;
      own << number(), number(), number(), number();
      own = own * own.transpose() + 3.0 * Eigen::Matrix2d::Identity();  // dominates: definite
      solver.diagonal[static_cast<size_t>(i)] = own;
      dense.block<2, 2>(2 * i, 2 * i) += own;
      right.segment<2>(2 * i) << number(), number();
      solver.right[static_cast<size_t>(i)] = right.segment<2>(2 * i);
    }
    const Eigen::VectorXd expected = dense.ldlt().solve(right);
    const std::vector<Eigen::Vector2d>& found = solver.solve();
    for (int i = 0; i < pins; ++i) {
      EXPECT_LT((found[static_cast<size_t>(i)] - expected.segment<2>(2 * i)).norm(), 1e-12)
          << "pin " << i << " of " << pins;
    }
  }
}

}  // namespace
}  // namespace screed
