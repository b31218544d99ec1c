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

// From a trained network in floating point to the integers of nn/infer: the scale of every layer is
// the finest whose sums provably fit 32 bits.

/// y = tanh(W x + b), or y = W x + b where linear. Batch normalisation and the steepness of an
/// activation are already part of W and b. Values lie within (-1, 1); a linear output beyond is
/// cut.
struct FloatLayer {
  std::size_t inputs = 0;
  std::size_t outputs = 0;
  bool linear = false;
  std::vector<double> weights;  ///< outputs x inputs, a row a node
  std::vector<double> bias;     ///< outputs
};

/// What the float network gives, for comparison.
std::vector<double> run(const std::vector<FloatLayer>& network, std::vector<double> values);

/// Throws InputError, which names the layer, when dimensions do not fit together, a number is not
/// finite, or weights are too large for any scale (the weights of a node may add up to 65,000).
IntegerNetwork quantise(const std::vector<FloatLayer>& network);

/// The same at the same scales, with the integers chosen so that the network comes closest to the
/// one in floating point on inputs such as it will see: `rows` of normalised values, as many as the
/// network has inputs, one row after the other. Layer by layer, each makes up for what the ones
/// before it and the rounding of its own weights have left, by least squares. No rows: as above.
IntegerNetwork quantise(const std::vector<FloatLayer>& network, std::span<const double> rows);

/// The activation that stands for a value, -1 to 1: floor(2^15 value), limited to int16_t.
std::int16_t to_activation(double value);
/// (q + 1/2) / 2^15
double to_value(std::int16_t activation);

}  // namespace screed::nn
