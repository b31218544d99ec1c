// The slip watch's network on the host: in floating point while it learns, and in the integers of
// nn/infer/gated.h.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "nn/infer/gated.h"
#include "nn/slip/stuck_rules.h"
#include "nn/training/trainer.h"

namespace screed::nn {

/// Rows are a bias and weights, columns of candidates and gates: bias, inputs, states; of outputs:
/// bias, states.
struct GatedNetwork {
  Eigen::MatrixXf candidates;
  Eigen::MatrixXf gates;
  Eigen::MatrixXf outputs;

  GatedShape shape() const;
};

inline constexpr float kWeightScale = 32.0F;                ///< a weight's integer for 1
inline constexpr float kMaxWeight = 127.0F / kWeightScale;  ///< what 8 bits hold

/// Random weights by the seed; gates open differently wide, so that units remember for different
/// times.
GatedNetwork random_network(const GatedShape& shape, std::uint64_t seed);

/// Each weight moved to what 8 bits can hold.
GatedNetwork rounded(GatedNetwork network);

/// The integers in the order of nn/infer/gated.h.
std::vector<std::int8_t> parameters_of(const GatedNetwork& network);

/// The integer network, step by step.
class GatedRunner {
 public:
  GatedRunner(const GatedShape& shape, std::vector<std::int8_t> parameters);

  void forget();
  /// Sums of the outputs, Q12.
  std::span<const std::int16_t> step(std::span<const std::int8_t> inputs);

 private:
  GatedShape shape_;
  std::vector<std::int8_t> parameters_;
  std::vector<std::int8_t> values_;
  std::vector<std::int16_t> candidates_, states_, outputs_;
};

// Training on sequences of steps, back through time.
//
// Loss of a step: held_weight (cross entropy of output 0 as the log of the odds with held)
//   + kShareLoss share_weight / 0.15 m/s (output 1 - share)^2.
// Adam (Kingma and Ba, 2015) over windows of kWindow steps of kLanes drives at once; the states go
// on from window to window, the gradient does not. From 40 % of the epochs on the forward pass has
// weights rounded to 8 bits, the gradient is taken as if it had not (straight through).

struct GatedTrainingOptions {
  std::uint64_t seed = 1;
  std::uint8_t units = kSlipUnits;
  std::size_t epochs = 150;
  EpochProgress progress;  ///< may be empty
};

/// The same sequences, options and build give the same network. Throws RunError without steps.
GatedNetwork train_gated(const std::vector<std::vector<SlipStep>>& sequences,
                         const GatedTrainingOptions& options);

/// Loss and its gradient over one window of sequences of equal length, states zero at the start;
/// for tests.
struct GatedGradient {
  double loss;
  GatedNetwork gradient;
};
GatedGradient gated_gradient(const GatedNetwork& network,
                             const std::vector<std::vector<SlipStep>>& lanes);

}  // namespace screed::nn
