// A robot's answer to a command, in words: what it refused, in which state, and what to do about
// it.
#pragma once

#include <cstdint>
#include <string>

#include "host_sim/ground_station/telemetry/latest_telemetry.h"

namespace screed {

struct CommandAnswer {
  uint8_t op = 0;
  uint8_t result = 0;  ///< 0: done
  uint16_t detail = 0;

  bool done() const { return result == 0; }
};

/// How the reader gives commands: by `screed send`, or by the keys of the monitor.
enum class CommandStyle : uint8_t { kProgram, kKeys };

/// "done", "refused: disarmed; arm first: screed send arm". `robot`: what it says of itself.
std::string answer_text(const CommandAnswer& answer, const LatestTelemetry& robot, uint64_t now_us,
                        CommandStyle style = CommandStyle::kProgram);

/// What stands behind "refused: "; empty when it is done.
std::string refusal_text(const CommandAnswer& answer, const LatestTelemetry& robot, uint64_t now_us,
                         CommandStyle style = CommandStyle::kProgram);

}  // namespace screed
