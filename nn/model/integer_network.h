// A network in integers as the host keeps it: what nn/infer computes, with its dimensions known at
// run time. Knows neither how it was trained nor what its inputs mean.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "nn/infer/dense.h"

namespace screed::nn {

/// One layer; for the meaning of the integers see nn/infer/dense.h.
struct IntegerLayer {
  std::uint8_t inputs = 0;
  std::uint8_t outputs = 0;
  std::uint8_t gain_shift = 0;
  bool linear = false;
  std::vector<std::int16_t> weights;  ///< outputs x inputs, a row a node
  std::vector<std::int32_t> bias;     ///< outputs

  DenseShape shape() const;
  /// The greatest |sum| that any input can bring about.
  std::int64_t max_abs_sum() const;
};

class IntegerNetwork {
 public:
  /// Throws InputError, which names the layer, when dimensions do not fit together or a sum could
  /// overflow 32 bits.
  explicit IntegerNetwork(std::vector<IntegerLayer> layers);

  std::size_t inputs() const { return layers_.front().inputs; }
  std::size_t outputs() const { return layers_.back().outputs; }
  const std::vector<IntegerLayer>& layers() const { return layers_; }
  /// The parameters of a layer as they lie in the robot's flash (nn/infer/dense.h).
  const std::vector<std::uint8_t>& parameters(std::size_t layer) const {
    return parameters_[layer];
  }

  /// in: inputs() numbers, out: outputs() numbers.
  void run(std::span<const std::int16_t> in, std::span<std::int16_t> out) const;

 private:
  std::vector<IntegerLayer> layers_;
  std::vector<std::vector<std::uint8_t>> parameters_;
};

}  // namespace screed::nn
