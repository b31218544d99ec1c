// What damage on the radio does: lines of random messages, each damaged in one way, through the
// firmware's parser and the checks of a receiver.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "firmware/protocol/slcan.h"
#include "host_sim/core/random.h"
#include "host_sim/ground_station/telemetry/schema.h"

namespace screed {

/// Frames of the schema with random content, as several robots and a ground station would send
/// them: right ids, sizes, counters, CRCs and MACs.
class RandomFrames {
 public:
  explicit RandomFrames(uint64_t seed) : random_(seed, "frames") {}

  /// A message of the schema, each as often; robots 1 to 3. Half of the bytes are edges.
  CanFrame next();
  /// One that goes up, or one that goes down.
  CanFrame next(bool uplink);

  /// A receiver would take it: known id, right way, right size, right CRC or, for a COMMAND, right
  /// MAC.
  static bool accepts(const CanFrame& frame, bool uplink);

 private:
  CanFrame fill(const MessageInfo& message);

  WorldRandom random_;
  std::array<uint8_t, 2048> counters_{};
};

struct CorruptionResult {
  std::string damage;         ///< "one wrong bit", ...
  uint64_t lines = 0;         ///< damaged lines, half of them of the uplink
  uint64_t wrong_lines = 0;   ///< frames that were not sent and passed the line parser
  uint64_t wrong_frames = 0;  ///< those of them that a receiver accepts
};

/// Damages `lines` lines in each of the ways. The same seed gives the same result.
std::vector<CorruptionResult> damage_lines(uint64_t lines, uint64_t seed);

}  // namespace screed
