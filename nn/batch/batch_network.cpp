#include "nn/batch/batch_network.h"

#include <algorithm>
#include <array>

#include "host_sim/core/errors.h"

namespace screed::nn {

namespace {

using BlockFunction = void (*)(const BlockLayer*, std::size_t, const std::int16_t*, std::int16_t*,
                               std::size_t);

using OneFunction = void (*)(const LaneLayer*, std::size_t, const std::int16_t*, std::int16_t*,
                             std::size_t);

struct Block {
  BlockFunction run;
  OneFunction run_one;
  std::size_t robots;
};

// So many robots, one after another, take about as long as a block: 2 to 3 with AVX-512, 3 to 4
// with AVX2 (networks of 4-20-1 and of 13 layers).
constexpr std::size_t kFewRobots = 3;

constexpr std::size_t kMaxBlockRobots = kAvx512Robots;

/// The baseline computes one robot after the other, by nn/infer.
Block block_of([[maybe_unused]] InstructionSet set) {
#ifdef __x86_64__
  if (set == InstructionSet::kAvx512) return {run_block_avx512, run_one_avx512, kAvx512Robots};
  if (set == InstructionSet::kAvx2) return {run_block_avx2, run_one_avx2, kAvx2Robots};
#endif
  return {nullptr, nullptr, 1};
}

std::int32_t weight_pair(const IntegerLayer& layer, std::size_t node, std::size_t input) {
  const std::int16_t* weight = &layer.weights[node * layer.inputs + input];
  const auto lower = static_cast<std::uint16_t>(weight[0]);
  const auto upper = static_cast<std::uint16_t>(input + 1 < layer.inputs ? weight[1] : 0);
  return static_cast<std::int32_t>(std::uint32_t{lower} | std::uint32_t{upper} << 16);
}

BlockLayer in_pairs(const IntegerLayer& layer) {
  BlockLayer result{layer.inputs, layer.outputs, 16 - layer.gain_shift, layer.linear,
                    {},           layer.bias};
  for (std::size_t node = 0; node < layer.outputs; ++node) {
    for (std::size_t i = 0; i < layer.inputs; i += 2)
      result.weight_pairs.push_back(weight_pair(layer, node, i));
  }
  return result;
}

/// Of a group of nodes in the order in which a register of so many narrows two registers of sums:
/// four of each in turn.
std::vector<std::size_t> order_of_sums(std::size_t lanes) {
  std::vector<std::size_t> order;
  for (const std::size_t half : {0U, 4U}) {
    for (std::size_t eight = 0; eight < lanes; eight += 8) {
      for (std::size_t i = 0; i < 4; ++i) order.push_back(eight + half + i);
    }
  }
  return order;
}

LaneLayer in_lanes(const IntegerLayer& layer, std::size_t lanes) {
  const std::size_t groups = (layer.outputs + lanes - 1) / lanes;
  LaneLayer result{
      layer.inputs, static_cast<int>(groups), 16 - layer.gain_shift, layer.linear, {}, {}};
  const std::vector<std::size_t> order = order_of_sums(lanes);
  for (std::size_t group = 0; group < groups; ++group) {
    const auto append = [&](std::vector<std::int32_t>& to, const auto& value_of_node) {
      for (const std::size_t place : order) {
        const std::size_t node = group * lanes + place;
        to.push_back(node < layer.outputs ? value_of_node(node) : 0);
      }
    };
    append(result.bias, [&](std::size_t node) { return layer.bias[node]; });
    for (std::size_t i = 0; i < layer.inputs; i += 2) {
      append(result.weight_pairs, [&](std::size_t node) { return weight_pair(layer, node, i); });
    }
  }
  return result;
}

}  // namespace

BatchNetwork::BatchNetwork(const IntegerNetwork& network)
    : BatchNetwork(network, instruction_sets().back()) {}

BatchNetwork::BatchNetwork(const IntegerNetwork& network, InstructionSet set)
    : network_(network), set_(set) {
  const std::vector<InstructionSet>& present = instruction_sets();
  if (std::find(present.begin(), present.end(), set) == present.end()) {
    throw InputError(std::string("network: this processor has no ") + name_of(set));
  }
  for (const IntegerLayer& layer : network.layers()) {
    if (set == InstructionSet::kBaseline) break;
    layers_.push_back(in_pairs(layer));
    lane_layers_.push_back(in_lanes(layer, block_of(set).robots));
  }
}

void BatchNetwork::run(const std::int16_t* in, std::int16_t* out, std::size_t robots,
                       std::size_t stride) const {
  const Block block = block_of(set_);
  if (block.run == nullptr) {
    std::array<std::int16_t, kMaxInputs> from;
    std::array<std::int16_t, kMaxInputs> to;
    for (std::size_t robot = 0; robot < robots; ++robot) {
      for (std::size_t i = 0; i < inputs(); ++i) from[i] = in[i * stride + robot];
      network_.run(from, to);
      for (std::size_t i = 0; i < outputs(); ++i) out[i * stride + robot] = to[i];
    }
    return;
  }
  std::size_t robot = 0;
  for (; robot + block.robots <= robots; robot += block.robots) {
    block.run(layers_.data(), layers_.size(), in + robot, out + robot, stride);
  }
  if (robots - robot <= kFewRobots) {
    std::array<std::int16_t, kMaxInputs> from;
    std::array<std::int16_t, kMaxInputs> to;
    for (; robot < robots; ++robot) {
      for (std::size_t i = 0; i < inputs(); ++i) from[i] = in[i * stride + robot];
      block.run_one(lane_layers_.data(), lane_layers_.size(), from.data(), to.data(), outputs());
      for (std::size_t i = 0; i < outputs(); ++i) out[i * stride + robot] = to[i];
    }
    return;
  }
  // The robots that do not fill a block, in a block of their own. The widest network's would take
  // longer to clear than a small one to run.
  std::array<std::int16_t, kMaxInputs * kMaxBlockRobots> from;
  std::array<std::int16_t, kMaxInputs * kMaxBlockRobots> to;
  const std::size_t rest = robots - robot;
  for (std::size_t i = 0; i < inputs(); ++i) {
    std::int16_t* const to_block = &from[i * block.robots];
    std::fill(std::copy_n(in + i * stride + robot, rest, to_block), to_block + block.robots,
              std::int16_t{0});
  }
  block.run(layers_.data(), layers_.size(), from.data(), to.data(), block.robots);
  for (std::size_t i = 0; i < outputs(); ++i) {
    std::copy_n(&to[i * block.robots], rest, out + i * stride + robot);
  }
}

}  // namespace screed::nn
