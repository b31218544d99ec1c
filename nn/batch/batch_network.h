// A network over many robots at once: the bits of nn/infer, several robots a machine instruction.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "nn/batch/block_kernel.h"
#include "nn/model/integer_network.h"

namespace screed::nn {

/// How a block of robots is computed; all give the same bits.
enum class BatchKernel : std::uint8_t { kScalar, kAvx2, kAvx512 };

const char* batch_kernel_name(BatchKernel kernel);
/// The kernels that this processor has, slowest first.
std::vector<BatchKernel> batch_kernels();

class BatchNetwork {
 public:
  /// Takes the fastest kernel of this processor.
  explicit BatchNetwork(const IntegerNetwork& network);
  /// Throws InputError when this processor does not have the kernel.
  BatchNetwork(const IntegerNetwork& network, BatchKernel kernel);

  std::size_t inputs() const { return network_.inputs(); }
  std::size_t outputs() const { return network_.outputs(); }
  BatchKernel kernel() const { return kernel_; }

  /// Robot r's input i is in[i * stride + r], its output j becomes out[j * stride + r], for r below
  /// robots, which is at most stride. in and out must not overlap. Allocates nothing.
  void run(const std::int16_t* in, std::int16_t* out, std::size_t robots, std::size_t stride) const;

 private:
  IntegerNetwork network_;
  BatchKernel kernel_;
  std::vector<BlockLayer> layers_;
  std::vector<LaneLayer> lane_layers_;
};

}  // namespace screed::nn
