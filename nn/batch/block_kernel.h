// The seam between BatchNetwork and the kernels that compute a block of robots, or one, with the
// vector instructions of a processor. A kernel's file includes nothing of the standard library's
// templates, so no code for a newer processor can reach the rest of the program.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include <vector>

namespace screed::nn {

/// A layer with its weights in pairs, as pmaddwd wants them: the lower half of a pair is the weight
/// of input 2 p, the upper one of input 2 p + 1 (0 where there is none).
struct BlockLayer {
  int inputs;
  int outputs;
  int shift;  ///< of a sum to tanh's argument, to the right
  bool linear;
  std::vector<int32_t> weight_pairs;  ///< outputs x ceil(inputs / 2)
  std::vector<int32_t> bias;          ///< outputs
};

/// The same for one robot alone, whose nodes lie beside each other in a register: with the others
/// of a block idle it would take several times as long. A register of 16-bit numbers holds a group
/// of nodes; their sums are two registers, as pairs_low and pairs_high (block_layers.inc) would
/// leave them. Nodes that are not there have weights of 0.
struct LaneLayer {
  int inputs;
  int groups;
  int shift;
  bool linear;
  std::vector<int32_t> weight_pairs;  ///< groups x ceil(inputs / 2) x (low, high)
  std::vector<int32_t> bias;          ///< groups x (low, high)
};

constexpr int kMaxLayerWidth = 255;

// One block: kAvx2Robots or kAvx512Robots robots through all layers. Number i of robot r is
// in[i * stride + r] and out[i * stride + r].
constexpr size_t kAvx2Robots = 16;
constexpr size_t kAvx512Robots = 32;
void run_block_avx2(const BlockLayer* layers, size_t count, const int16_t* in, int16_t* out,
                    size_t stride);
void run_block_avx512(const BlockLayer* layers, size_t count, const int16_t* in, int16_t* out,
                      size_t stride);

// One robot: its number i is in[i]; out[0..outputs).
void run_one_avx2(const LaneLayer* layers, size_t count, const int16_t* in, int16_t* out,
                  size_t outputs);
void run_one_avx512(const LaneLayer* layers, size_t count, const int16_t* in, int16_t* out,
                    size_t outputs);

}  // namespace screed::nn
