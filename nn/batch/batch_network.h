// A network over many robots at once: the bits of nn/infer, several robots a machine instruction.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "host_sim/core/lanes/instruction_set.h"
#include "nn/batch/block_kernel.h"
#include "nn/model/quantiser.h"

namespace screed::nn {

class BatchNetwork {
 public:
  /// With the best instructions of this processor; all give the same bits.
  explicit BatchNetwork(const IntegerNetwork& network);
  /// Throws InputError when this processor does not have them.
  BatchNetwork(const IntegerNetwork& network, InstructionSet set);

  std::size_t inputs() const { return network_.inputs(); }
  std::size_t outputs() const { return network_.outputs(); }
  InstructionSet instructions() const { return set_; }

  /// Robot r's input i is in[i * stride + r], its output j becomes out[j * stride + r], for r below
  /// robots, which is at most stride. in and out must not overlap. Allocates nothing.
  void run(const std::int16_t* in, std::int16_t* out, std::size_t robots, std::size_t stride) const;

 private:
  IntegerNetwork network_;
  InstructionSet set_;
  std::vector<BlockLayer> layers_;
  std::vector<LaneLayer> lane_layers_;
};

}  // namespace screed::nn
