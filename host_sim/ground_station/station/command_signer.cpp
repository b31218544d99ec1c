// Signing of commands, and the freshness they need.
#include "host_sim/ground_station/station/command_signer.h"

#include <algorithm>

#include "firmware/security/command_mac.h"
#include "host_sim/core/errors.h"
#include "schema/class_values.h"

namespace screed {
namespace {

// A robot takes the 8 bits that travel for one of the next 256 numbers. Who is farther ahead,
// because nothing got through, begins again where the robot is.
constexpr int kMaxAhead = 200;

/// The robot has taken the command, whatever came of it.
bool was_taken(message::CommandAckResult result) {
  using Result = message::CommandAckResult;
  return result != Result::kNoKey && result != Result::kBadMac && result != Result::kLockedOut &&
         result != Result::kUsedUp;
}

}  // namespace

uint32_t command_argument(const DriveArgument& argument) {
  uint8_t bytes[3];
  put_drive_argument(bytes, argument);
  return static_cast<uint32_t>(bytes[0] | bytes[1] << 8 | bytes[2] << 16);
}

void CommandSigner::handle_frame(const CanFrame& frame) {
  if (frame.id == id_of_node(kIdCommandAck, node()) && ready()) {
    const auto ack = message::CommandAck::unpack(frame.data);
    const auto ahead = static_cast<uint8_t>(ack.freshness - (counter_ & 0xFFU));
    const bool is_newer = ahead != 0 && ahead < 128;
    if (is_newer && was_taken(static_cast<message::CommandAckResult>(ack.result)))
      counter_ = static_cast<uint16_t>(counter_ + ahead);
    return;
  }
  if (frame.id != id_of_node(kIdHeartbeat, node()) || frame.size != message::Heartbeat::kSize)
    return;
  const auto heartbeat = message::Heartbeat::unpack(frame.data);
  const uint16_t epoch = heartbeat.boot_epoch;
  const uint16_t counter = heartbeat.freshness;
  const bool behind = counter > counter_;
  if (epoch != boot_epoch_ || behind || counter_ - counter > kMaxAhead) counter_ = counter;
  boot_epoch_ = epoch;
}

CanFrame CommandSigner::sign(CommandOp op, uint32_t argument) {
  if (!boot_epoch_.has_value()) {
    throw RunError("no heartbeat of the robot was heard: a command for it cannot be signed");
  }
  if (counter_ == UINT16_MAX) {
    throw RunError("the robot has taken all 65,535 commands of this start; restart it");
  }
  ++counter_;
  CanFrame frame{};
  frame.id = id_of_node(kIdCommand, node());
  frame.size = kCommandSize;
  frame.data[0] = static_cast<uint8_t>(op);
  for (int i = 0; i < 3; ++i) frame.data[1 + i] = static_cast<uint8_t>(argument >> (8 * i));
  frame.data[kCommandFreshnessOffset] = static_cast<uint8_t>(counter_ & 0xFFU);
  uint8_t mac[kSipHashSize];
  command_mac(key_.bytes.data(), frame.id, key_.robot_id, *boot_epoch_, counter_, frame.data, mac);
  std::copy_n(mac, kCommandMacSize, frame.data + kCommandMacOffset);
  return frame;
}

CanFrame CommandSigner::sign(CommandOp op, const DriveArgument& argument) {
  return sign(op, command_argument(argument));
}

}  // namespace screed
