// What a ground station sends: protected frames as text lines.
#pragma once

#include <cstdint>
#include <vector>

#include "firmware/telemetry/messages.h"

namespace screed::mcu {

class GroundLines {
 public:
  std::vector<std::uint8_t> heartbeat(std::uint32_t time_ms);
  std::vector<std::uint8_t> command(CommandOp op, DriveArgument argument = {0, 0});

 private:
  std::uint8_t heartbeat_counter_ = 0;
  std::uint8_t command_counter_ = 0;
};

/// The frames among received bytes whose check is right, in order.
std::vector<CanFrame> frames_in(const std::vector<std::uint8_t>& bytes);

}  // namespace screed::mcu
