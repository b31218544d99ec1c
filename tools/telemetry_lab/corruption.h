// What damage on the radio does: lines of random messages, each damaged in one way, through the
// firmware's parser and the checks of a receiver.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace screed {

struct CorruptionResult {
  std::string damage;         ///< "one wrong bit", ...
  uint64_t lines = 0;         ///< damaged lines
  uint64_t wrong_lines = 0;   ///< frames taken from lines that a parser without length check and
                              ///< CRC would have to believe: the parser alone
  uint64_t wrong_frames = 0;  ///< accepted by all checks, and not a frame that was sent
};

/// Damages `lines` lines in each of the ways. The same seed gives the same result.
std::vector<CorruptionResult> damage_lines(uint64_t lines, uint64_t seed);

}  // namespace screed
