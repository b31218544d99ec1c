// Better than Algorithm 1 with the same information: height of the cell, whether the last step
// succeeded, no map, no communication. Two algorithms are settings of this agent
// (docs/grid-world.md has the figures):
//   patient  a running average in place of eight sparse samples, straight walks, and a dead band
//            around the average within which nothing is moved, unless it has waited too long
//   forager  turns back after every operation, runs and tumbles along the slope, and holds out for
//            a place as high or low as the last one
#pragma once

#include <stdint.h>

#include "host_sim/grid/agents/grid_random.h"
#include "host_sim/grid/agents/grid_types.h"

namespace screed {

struct ForagingParameters {
  Probability sense;      ///< of sampling the height on arrival in a cell
  uint16_t averaging;     ///< samples that the average forgets after, 1..32767
  uint16_t dead_band_q8;  ///< least distance from the average of a cell worth an operation, 1/256
                          ///< unit
  uint16_t patience;      ///< cycles without an operation before the dead band shrinks, gone after
                          ///< twice as many; 0: it never shrinks
  uint16_t hold_out;      ///< cycles over which the agent lowers its claim from the last place's
                          ///< distance to the dead band; 0: takes the first
  Probability turn;       ///< of a new direction in a cycle; a blocked agent always takes one
  bool follows_slope;     ///< never turns while the height improves, eight times as often while it
                       ///< gets worse (uphill is better for empty agents, downhill for loaded ones)
  bool turns_back;  ///< after an operation the way it came, in the same cycle
};

class ForagingAgent {
 public:
  /// Samples before the first operation.
  static constexpr uint16_t kMinSamples = 8;

  ForagingAgent(const ForagingParameters& parameters, uint32_t seed, uint32_t stream);

  /// One cycle: sense, operation, step.
  GridAction tick(const GridInput& input);

  bool carries() const { return carries_; }
  /// The average height, Q16.
  int32_t average_q16() const { return average_q16_; }

 private:
  void sense(int32_t height_q16);
  int32_t claim_q16() const;
  GridOperation operate(uint16_t height);
  uint8_t step(const GridInput& input, GridOperation operation);
  Probability turn_probability(uint16_t height) const;

  GridRandom random_;
  ForagingParameters parameters_;
  int32_t average_q16_ = 0;
  int32_t patience_slope_q16_;              ///< dead band given up in a cycle, after patience
  int32_t hold_out_slope_q16_[2] = {0, 0};  ///< claim lowered in a cycle; empty, loaded
  uint16_t samples_ = 0;
  uint16_t waited_ = 0;  ///< cycles since the last operation
  uint16_t last_height_ = 0;
  uint8_t direction_;
  bool carries_ = false;
};

}  // namespace screed
