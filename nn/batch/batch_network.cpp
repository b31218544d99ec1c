#include "nn/batch/batch_network.h"

#include <algorithm>
#include <array>

#include "host_sim/core/errors.h"

namespace screed::nn {

namespace {

using BlockFunction = void (*)(const BlockLayer*, std::size_t, const std::int16_t*, std::int16_t*,
                               std::size_t);

struct Block {
  BlockFunction run;
  std::size_t robots;
};

constexpr std::size_t kMaxRobots = kAvx512Robots;

Block block_of(BatchKernel kernel) {
  return kernel == BatchKernel::kAvx512 ? Block{run_block_avx512, kAvx512Robots}
                                        : Block{run_block_avx2, kAvx2Robots};
}

BlockLayer in_pairs(const IntegerLayer& layer) {
  BlockLayer result{layer.inputs, layer.outputs, 16 - layer.gain_shift, layer.linear,
                    {},           layer.bias};
  for (std::size_t node = 0; node < layer.outputs; ++node) {
    for (std::size_t i = 0; i < layer.inputs; i += 2) {
      const std::int16_t* weight = &layer.weights[node * layer.inputs + i];
      const auto lower = static_cast<std::uint16_t>(weight[0]);
      const auto upper = static_cast<std::uint16_t>(i + 1 < layer.inputs ? weight[1] : 0);
      result.weight_pairs.push_back(
          static_cast<std::int32_t>(std::uint32_t{lower} | std::uint32_t{upper} << 16));
    }
  }
  return result;
}

}  // namespace

const char* batch_kernel_name(BatchKernel kernel) {
  switch (kernel) {
    case BatchKernel::kAvx512:
      return "AVX-512";
    case BatchKernel::kAvx2:
      return "AVX2";
    default:
      return "scalar";
  }
}

std::vector<BatchKernel> batch_kernels() {
  std::vector<BatchKernel> kernels = {BatchKernel::kScalar};
  if (__builtin_cpu_supports("avx2")) kernels.push_back(BatchKernel::kAvx2);
  if (__builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vnni")) {
    kernels.push_back(BatchKernel::kAvx512);
  }
  return kernels;
}

BatchNetwork::BatchNetwork(const IntegerNetwork& network)
    : BatchNetwork(network, batch_kernels().back()) {}

BatchNetwork::BatchNetwork(const IntegerNetwork& network, BatchKernel kernel)
    : network_(network), kernel_(kernel) {
  const std::vector<BatchKernel> present = batch_kernels();
  if (std::find(present.begin(), present.end(), kernel) == present.end()) {
    throw InputError(std::string("network: this processor has no ") + batch_kernel_name(kernel));
  }
  for (const IntegerLayer& layer : network.layers()) layers_.push_back(in_pairs(layer));
}

void BatchNetwork::run(const std::int16_t* in, std::int16_t* out, std::size_t robots,
                       std::size_t stride) const {
  if (kernel_ == BatchKernel::kScalar) {
    std::array<std::int16_t, kMaxInputs> from;
    std::array<std::int16_t, kMaxInputs> to;
    for (std::size_t robot = 0; robot < robots; ++robot) {
      for (std::size_t i = 0; i < inputs(); ++i) from[i] = in[i * stride + robot];
      network_.run(from, to);
      for (std::size_t i = 0; i < outputs(); ++i) out[i * stride + robot] = to[i];
    }
    return;
  }
  const Block block = block_of(kernel_);
  std::size_t robot = 0;
  for (; robot + block.robots <= robots; robot += block.robots) {
    block.run(layers_.data(), layers_.size(), in + robot, out + robot, stride);
  }
  if (robot == robots) return;
  // The robots that do not fill a block, in a block of their own.
  std::array<std::int16_t, kMaxInputs * kMaxRobots> from{};
  std::array<std::int16_t, kMaxInputs * kMaxRobots> to;
  const std::size_t rest = robots - robot;
  for (std::size_t i = 0; i < inputs(); ++i) {
    std::copy_n(in + i * stride + robot, rest, &from[i * block.robots]);
  }
  block.run(layers_.data(), layers_.size(), from.data(), to.data(), block.robots);
  for (std::size_t i = 0; i < outputs(); ++i) {
    std::copy_n(&to[i * block.robots], rest, out + i * stride + robot);
  }
}

}  // namespace screed::nn
