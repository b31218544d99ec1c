// What a ground station sends: protected frames as text lines.
#pragma once

#include <cstdint>
#include <vector>

#include "firmware/parameters/parameters.h"
#include "firmware/protocol/messages.h"
#include "host_sim/ground_station/station/command_key.h"

namespace screed::mcu {

class GroundLines {
 public:
  /// Signs with the test key, for a robot in its first start with that key; handle_frame() a
  /// heartbeat of the robot when it is not.
  GroundLines();
  void handle_frame(const CanFrame& frame) { signer_.handle_frame(frame); }

  std::vector<std::uint8_t> heartbeat(std::uint32_t time_ms);
  std::vector<std::uint8_t> command(CommandOp op, DriveArgument argument = {0, 0});
  /// Both lines that set a parameter: the value, and the command that commits it.
  std::vector<std::uint8_t> parameter(Parameters::Number number, std::int16_t value);

 private:
  std::uint8_t heartbeat_counter_ = 0;
  std::uint8_t stage_counter_ = 0;
  CommandSigner signer_;
};

/// The frames among received bytes whose check is right, in order.
std::vector<CanFrame> frames_in(const std::vector<std::uint8_t>& bytes);

}  // namespace screed::mcu
