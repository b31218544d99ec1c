// The slip watch's network on the host: in floating point while it learns, and in the integers of
// nn/infer/gated.h.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "nn/infer/gated.h"

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

}  // namespace screed::nn
