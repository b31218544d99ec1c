#include "nn/model/quantiser.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "host_sim/core/errors.h"

namespace screed::nn {

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
  if (result.greatest_sum() > std::numeric_limits<std::int32_t>::max()) return std::nullopt;
  return result;
}

IntegerLayer finest(const FloatLayer& layer, std::size_t number) {
  const std::string name = "network: layer " + std::to_string(number);
  if (layer.inputs < 1 || layer.inputs > kMostInputs || layer.outputs < 1 ||
      layer.outputs > kMostInputs || layer.weights.size() != layer.inputs * layer.outputs ||
      layer.bias.size() != layer.outputs) {
    throw InputError(name + ": dimensions do not fit together; allowed is 1 to 255 a side");
  }
  const auto finite = [](double value) { return std::isfinite(value); };
  if (!std::all_of(layer.weights.begin(), layer.weights.end(), finite) ||
      !std::all_of(layer.bias.begin(), layer.bias.end(), finite)) {
    throw InputError(name + ": a weight or bias is not finite");
  }
  for (int gain_shift = 0; gain_shift <= kMostGainShift; ++gain_shift) {
    if (std::optional<IntegerLayer> result = scaled(layer, gain_shift)) return *std::move(result);
  }
  throw InputError(name + ": weights are too large for 16 bits at any scale");
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

std::int16_t to_activation(double value) {
  return static_cast<std::int16_t>(
      std::clamp(std::floor(std::ldexp(value, 15)), -32768.0, 32767.0));
}

double to_value(std::int16_t activation) {
  return std::ldexp(activation + 0.5, -15);
}

}  // namespace screed::nn
