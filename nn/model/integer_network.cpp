#include "nn/model/integer_network.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <limits>
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

}  // namespace screed::nn
