#include "nn/model/quantiser.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>
#include <string>

#include "host_sim/core/errors.h"

namespace screed::nn {

namespace {

[[noreturn]] void refuse(std::size_t layer, const std::string& what) {
  throw InputError("network: layer " + std::to_string(layer + 1) + ": " + what);
}

void check(const std::vector<IntegerLayer>& layers) {
  if (layers.empty()) throw InputError("network: no layers; allowed is one or more");
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const IntegerLayer& layer = layers[i];
    if (layer.inputs == 0 || layer.outputs == 0) {
      refuse(i, "no inputs or no outputs; allowed is 1 to 255");
    }
    if (i > 0 && layers[i - 1].outputs != layer.inputs) {
      refuse(i, std::to_string(layer.inputs) + " inputs after " +
                    std::to_string(layers[i - 1].outputs) + " outputs; they must be equal");
    }
    if (layer.gain_shift > kMaxGainShift) {
      refuse(i, "gain shift " + std::to_string(layer.gain_shift) + "; allowed is 0 to " +
                    std::to_string(kMaxGainShift));
    }
    if (layer.weights.size() != std::size_t{layer.inputs} * layer.outputs ||
        layer.bias.size() != layer.outputs) {
      refuse(i, "needs " + std::to_string(layer.inputs * layer.outputs) + " weights and " +
                    std::to_string(layer.outputs) + " biases, has " +
                    std::to_string(layer.weights.size()) + " and " +
                    std::to_string(layer.bias.size()));
    }
    if (layer.max_abs_sum() > std::numeric_limits<std::int32_t>::max()) {
      refuse(i, "a sum can reach " + std::to_string(layer.max_abs_sum()) +
                    "; allowed is less than 2^31");
    }
  }
}

void put(std::vector<std::uint8_t>& bytes, std::uint32_t value, int size) {
  for (int byte = 0; byte < size; ++byte) {
    bytes.push_back(static_cast<std::uint8_t>(value >> (8 * byte)));
  }
}

std::vector<std::uint8_t> packed(const IntegerLayer& layer) {
  std::vector<std::uint8_t> bytes;
  for (std::size_t node = 0; node < layer.outputs; ++node) {
    const std::span row(&layer.weights[node * layer.inputs], layer.inputs);
    std::uint32_t constant =
        static_cast<std::uint32_t>(layer.bias[node]) + (std::uint32_t{layer.inputs} << 30);
    for (const std::int16_t weight : row) {
      constant -= static_cast<std::uint32_t>(weight + 0x8000) << 15;
    }
    put(bytes, constant, 4);
    for (const std::int16_t weight : row) {
      put(bytes, static_cast<std::uint32_t>(weight + 0x8000), 2);
    }
  }
  return bytes;
}

}  // namespace

DenseShape IntegerLayer::shape() const {
  return {inputs, outputs, static_cast<std::uint8_t>(gain_shift | (linear ? kLinear : 0))};
}

std::int64_t IntegerLayer::max_abs_sum() const {
  std::int64_t greatest = 0;
  for (std::size_t node = 0; node < outputs; ++node) {
    std::int64_t sum = std::abs(static_cast<std::int64_t>(bias[node]));
    for (std::size_t i = 0; i < inputs; ++i) {
      sum += std::abs(static_cast<std::int64_t>(weights[node * inputs + i])) * 0x8000;
    }
    greatest = std::max(greatest, sum);
  }
  return greatest;
}

IntegerNetwork::IntegerNetwork(std::vector<IntegerLayer> layers) : layers_(std::move(layers)) {
  check(layers_);
  for (const IntegerLayer& layer : layers_) parameters_.push_back(packed(layer));
}

void IntegerNetwork::run(std::span<const std::int16_t> in, std::span<std::int16_t> out) const {
  std::array<std::int16_t, kMaxInputs> from;
  std::array<std::int16_t, kMaxInputs> to;
  std::copy_n(in.begin(), inputs(), from.begin());
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    dense(layers_[i].shape(), parameters_[i].data(), from.data(), to.data());
    std::swap(from, to);
  }
  std::copy_n(from.begin(), outputs(), out.begin());
}

namespace {

// A sum of 2^(29 - gain_shift) is an argument of 1; where there is no tanh the argument of 1/4 is
// the result 1 (both are 16-bit numbers, one of steps of 2^-13, the other of 2^-15).
constexpr int kSumOfOne = 29;
constexpr int kWeightOfOne = 14;
constexpr double kLinearGain = 4.0;

std::optional<IntegerLayer> scaled(const FloatLayer& layer, int gain_shift) {
  IntegerLayer result;
  result.inputs = static_cast<std::uint8_t>(layer.inputs);
  result.outputs = static_cast<std::uint8_t>(layer.outputs);
  result.gain_shift = static_cast<std::uint8_t>(gain_shift);
  result.linear = layer.linear;
  const double gain = layer.linear ? kLinearGain : 1.0;
  for (std::size_t node = 0; node < layer.outputs; ++node) {
    double half_weights = 0.0;
    for (std::size_t i = 0; i < layer.inputs; ++i) {
      const double weight = std::nearbyint(
          std::ldexp(gain * layer.weights[node * layer.inputs + i], kWeightOfOne - gain_shift));
      if (std::abs(weight) > std::numeric_limits<std::int16_t>::max()) return std::nullopt;
      result.weights.push_back(static_cast<std::int16_t>(weight));
      half_weights += weight / 2.0;
    }
    // An activation stands for the middle of its step: w (q + 1/2).
    const double bias =
        std::nearbyint(std::ldexp(gain * layer.bias[node], kSumOfOne - gain_shift) + half_weights);
    if (std::abs(bias) > std::numeric_limits<std::int32_t>::max()) return std::nullopt;
    result.bias.push_back(static_cast<std::int32_t>(bias));
  }
  if (result.max_abs_sum() > std::numeric_limits<std::int32_t>::max()) return std::nullopt;
  return result;
}

IntegerLayer finest(const FloatLayer& layer, std::size_t number) {
  const std::string name = "network: layer " + std::to_string(number);
  if (layer.inputs < 1 || layer.inputs > kMaxInputs || layer.outputs < 1 ||
      layer.outputs > kMaxInputs || layer.weights.size() != layer.inputs * layer.outputs ||
      layer.bias.size() != layer.outputs) {
    throw InputError(name + ": dimensions do not fit together; allowed is 1 to 255 a side");
  }
  const auto finite = [](double value) { return std::isfinite(value); };
  if (!std::all_of(layer.weights.begin(), layer.weights.end(), finite) ||
      !std::all_of(layer.bias.begin(), layer.bias.end(), finite)) {
    throw InputError(name + ": a weight or bias is not finite");
  }
  for (int gain_shift = 0; gain_shift <= kMaxGainShift; ++gain_shift) {
    if (std::optional<IntegerLayer> result = scaled(layer, gain_shift)) return *std::move(result);
  }
  throw InputError(name + ": weights are too large for 16 bits at any scale");
}

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// What pulls a fitted weight back to the trained one, as a share of the inputs' mean square:
/// inputs that nearly always move together must not bring about weights that are far off for
/// others.
constexpr double kPull = 1e-4;

/// The node's weights on steps of `step` and its bias, for the least mean square of (weights inputs
/// + bias - wanted) share over the columns of `inputs`, the last row of which is 1. One weight
/// after the other is rounded, and those that are still free make up for it.
VectorXd fitted_node(const MatrixXd& inputs, const VectorXd& wanted, const VectorXd& share,
                     const VectorXd& trained, double step) {
  const Eigen::Index count = trained.size() - 1;
  const MatrixXd felt = inputs * share.asDiagonal();
  MatrixXd squares = felt * felt.transpose() / static_cast<double>(inputs.cols());
  const VectorXd missing = share.cwiseProduct(wanted - inputs.transpose() * trained);
  const VectorXd slope = felt * missing / static_cast<double>(inputs.cols());
  const double pull = kPull * (squares.trace() / static_cast<double>(count + 1)) + 1e-12;
  squares.diagonal().array() += pull;
  squares(count, count) -= pull * (1.0 - 1e-6);  // a bias is free
  VectorXd node = trained + squares.partialPivLu().solve(slope);
  const double most = step * std::numeric_limits<std::int16_t>::max();
  for (Eigen::Index i = 0; i < count; ++i) {
    const double rounded = std::clamp(step * std::nearbyint(node(i) / step), -most, most);
    const double off = rounded - node(i);
    node(i) = rounded;
    const Eigen::Index free = count - i;
    node.tail(free) -= squares.bottomRightCorner(free, free)
                           .partialPivLu()
                           .solve(VectorXd(squares.col(i).tail(free))) *
                       off;
  }
  return node;
}

/// A layer whose inputs are `seen` in integers and whose sums should be those of `wanted`, both a
/// column a row of the data.
IntegerLayer fitted(const FloatLayer& layer, const IntegerLayer& plain, const MatrixXd& seen,
                    const MatrixXd& wanted) {
  MatrixXd inputs(seen.rows() + 1, seen.cols());
  inputs << seen, MatrixXd::Ones(1, seen.cols());
  const double step =
      std::ldexp(1.0 / (layer.linear ? kLinearGain : 1.0), plain.gain_shift - kWeightOfOne);
  FloatLayer result = layer;
  for (std::size_t node = 0; node < layer.outputs; ++node) {
    VectorXd trained(inputs.rows());
    for (std::size_t i = 0; i < layer.inputs; ++i) {
      trained(static_cast<Eigen::Index>(i)) = layer.weights[node * layer.inputs + i];
    }
    trained(inputs.rows() - 1) = layer.bias[node];
    const VectorXd sums = wanted.row(static_cast<Eigen::Index>(node)).transpose();
    // What a change of the sum is to the result.
    const VectorXd share =
        layer.linear ? VectorXd::Ones(sums.size()) : VectorXd(1.0 - sums.array().tanh().square());
    const VectorXd found = fitted_node(inputs, sums, share, trained, step);
    for (std::size_t i = 0; i < layer.inputs; ++i) {
      result.weights[node * layer.inputs + i] = found(static_cast<Eigen::Index>(i));
    }
    result.bias[node] = found(inputs.rows() - 1);
  }
  // Weights that came out greater may not fit the scale.
  return scaled(result, plain.gain_shift).value_or(plain);
}

/// What a layer makes of activations, as values.
MatrixXd outputs_of(const IntegerLayer& layer, const MatrixXd& seen) {
  const IntegerNetwork network({layer});
  MatrixXd result(static_cast<Eigen::Index>(network.outputs()), seen.cols());
  std::vector<std::int16_t> in(network.inputs());
  std::vector<std::int16_t> out(network.outputs());
  for (Eigen::Index column = 0; column < seen.cols(); ++column) {
    for (std::size_t i = 0; i < in.size(); ++i) {
      in[i] = to_activation(seen(static_cast<Eigen::Index>(i), column));
    }
    network.run(in, out);
    for (std::size_t i = 0; i < out.size(); ++i) {
      result(static_cast<Eigen::Index>(i), column) = to_value(out[i]);
    }
  }
  return result;
}

}  // namespace

std::vector<double> run(const std::vector<FloatLayer>& network, std::vector<double> values) {
  for (const FloatLayer& layer : network) {
    std::vector<double> next(layer.outputs);
    for (std::size_t node = 0; node < layer.outputs; ++node) {
      double sum = layer.bias[node];
      for (std::size_t i = 0; i < layer.inputs; ++i) {
        sum += layer.weights[node * layer.inputs + i] * values[i];
      }
      next[node] = layer.linear ? sum : std::tanh(sum);
      // In integers a linear node ends at -1 and 1; of results that is part of the rounding error.
      if (&layer != &network.back()) next[node] = std::clamp(next[node], -1.0, 1.0);
    }
    values = std::move(next);
  }
  return values;
}

IntegerNetwork quantise(const std::vector<FloatLayer>& network) {
  std::vector<IntegerLayer> layers;
  layers.reserve(network.size());
  for (const FloatLayer& layer : network) layers.push_back(finest(layer, layers.size() + 1));
  return IntegerNetwork(std::move(layers));
}

IntegerNetwork quantise(const std::vector<FloatLayer>& network, std::span<const double> rows) {
  IntegerNetwork plain = quantise(network);
  const auto inputs = static_cast<Eigen::Index>(plain.inputs());
  const Eigen::Index count = static_cast<Eigen::Index>(rows.size()) / inputs;
  if (count == 0) return plain;
  // The same rows as floating point sees them, and as integers do.
  MatrixXd values =
      Eigen::Map<const MatrixXd>(rows.data(), inputs, count).cwiseMin(1.0).cwiseMax(-1.0);
  MatrixXd seen = values.unaryExpr([](double value) { return to_value(to_activation(value)); });
  std::vector<IntegerLayer> layers;
  layers.reserve(network.size());
  for (const FloatLayer& layer : network) {
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const Eigen::Map<const RowMajor> weights(layer.weights.data(),
                                             static_cast<Eigen::Index>(layer.outputs),
                                             static_cast<Eigen::Index>(layer.inputs));
    MatrixXd sums = weights * values;
    sums.colwise() +=
        Eigen::Map<const VectorXd>(layer.bias.data(), static_cast<Eigen::Index>(layer.outputs));
    layers.push_back(fitted(layer, plain.layers()[layers.size()], seen, sums));
    seen = outputs_of(layers.back(), seen);
    values =
        layer.linear ? MatrixXd(sums.cwiseMin(1.0).cwiseMax(-1.0)) : MatrixXd(sums.array().tanh());
  }
  return IntegerNetwork(std::move(layers));
}

std::int16_t to_activation(double value) {
  return static_cast<std::int16_t>(
      std::clamp(std::floor(std::ldexp(value, 15)), -32768.0, 32767.0));
}

double to_value(std::int16_t activation) {
  return std::ldexp(activation + 0.5, -15);
}

}  // namespace screed::nn
