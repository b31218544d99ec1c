// What damage on the radio does: lines of random messages, each damaged in one way, through the
// firmware's parser and the checks of a receiver.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace screed {

struct CorruptionResult {
  std::string damage;         ///< "one wrong bit", ...
  uint64_t lines = 0;         ///< damaged lines, half of them of the uplink
  uint64_t wrong_lines = 0;   ///< frames that were not sent and passed the line parser
  uint64_t wrong_frames = 0;  ///< those of them that a receiver accepts
};

/// Damages `lines` lines in each of the ways. The same seed gives the same result.
std::vector<CorruptionResult> damage_lines(uint64_t lines, uint64_t seed);

}  // namespace screed
