// Makes COMMAND frames that a robot accepts: holds the key, and follows the robot's freshness.
//
//   CommandSigner signer(read_key_file(file));
//   for every frame received:  signer.handle_frame(frame);
//   if (signer.ready())        send(signer.sign(CommandOp::kArm));
//
// A command that was not answered is sent again as the same frame: the robot does it once and
// answers every time. Commands go at most four times a second.
#pragma once

#include <cstdint>
#include <optional>

#include "firmware/protocol/messages.h"
#include "host_sim/ground_station/station/command_key.h"

namespace screed {

/// The 24 bits of a command whose argument is that of a drive or a position fix.
uint32_t command_argument(const DriveArgument& argument);

class CommandSigner {
 public:
  explicit CommandSigner(const CommandKey& key) : key_(key) {}

  /// The node of the robot that has the key.
  uint8_t node() const { return node_of_robot(key_.robot_id); }

  /// Takes a frame whose protection was found right: heartbeats of the robot, and its answers,
  /// which also tell what others have commanded. All else is ignored.
  void handle_frame(const CanFrame& frame);

  /// A heartbeat was heard: number of the robot's start and its counter are known.
  bool ready() const { return boot_epoch_.has_value(); }

  /// The next command; argument: 24 bits. Throws RunError before ready().
  CanFrame sign(CommandOp op, uint32_t argument = 0);
  CanFrame sign(CommandOp op, const DriveArgument& argument);

  uint16_t boot_epoch() const { return boot_epoch_.value_or(0); }
  /// Counter of the command signed last.
  uint16_t counter() const { return counter_; }

 private:
  CommandKey key_;
  std::optional<uint16_t> boot_epoch_;
  uint16_t counter_ = 0;
};

}  // namespace screed
