// Algorithm 1 of the thesis: picks up above the sensed mean and deposits below it, each with a
// probability, and walks at random (Algorithm 2). With constant probabilities or with the response
// thresholds of 4.2.1.
#pragma once

#include <stdint.h>

#include "host_sim/grid/agents/grid_random.h"
#include "host_sim/grid/agents/grid_types.h"
#include "host_sim/grid/agents/height_memory.h"

namespace screed {

struct ProbabilisticParameters {
  Probability sense;      ///< of sampling the height on arrival in a cell
  Probability pick_up;    ///< when the cell is above the mean; unused with a threshold
  Probability deposit;    ///< when the cell is below the mean; unused with a threshold
  Probability turn;       ///< of a step in a random direction; otherwise the last one again
  uint16_t threshold_q8;  ///< k of the response curves in 1/256 unit; 0: the constant probabilities
                          ///< above
  uint8_t memory_length;  ///< samples in the mean, 1..HeightMemory::kMaxLength
};

class ProbabilisticAgent {
 public:
  ProbabilisticAgent(const ProbabilisticParameters& parameters, uint32_t seed, uint32_t stream);

  /// One cycle: sense, then operation and step. Nothing is picked up or deposited before the first
  /// sample.
  GridAction tick(const GridInput& input);

  bool carries() const { return carries_; }

 private:
  /// Of the operation that is next, on a stack of that height.
  Probability probability(uint16_t height) const;

  GridRandom random_;
  HeightMemory memory_;
  ProbabilisticParameters parameters_;
  uint8_t direction_;
  bool carries_ = false;
};

}  // namespace screed
