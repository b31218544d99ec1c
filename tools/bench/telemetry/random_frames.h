// Frames of the schema with random content, as several robots and a ground station would send
// them: right ids, sizes, counters, CRCs and MACs.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/protocol/slcan.h"
#include "host_sim/core/random.h"
#include "host_sim/ground_station/telemetry/schema.h"

namespace screed {

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

}  // namespace screed
