#include "host_sim/ground_station/station/command_key.h"

#include <algorithm>
#include <charconv>
#include <numeric>

#include "firmware/math/crc16.h"
#include "firmware/protocol/e2e.h"
#include "firmware/security/command_mac.h"
#include "host_sim/core/errors.h"
#include "schema/class_values.h"

namespace screed {

namespace {

constexpr size_t kDigits = size_t{2} * kSipHashKeySize;

template <class Number>
bool parse(const std::string& text, size_t at, size_t count, int base, Number& value) {
  const char* const begin = text.data() + at;
  const auto result = std::from_chars(begin, begin + count, value, base);
  return result.ec == std::errc() && result.ptr == begin + count;
}

}  // namespace

CommandKey test_key() {
  CommandKey key;
  std::iota(key.bytes.begin(), key.bytes.end(), uint8_t{0});
  return key;
}

std::string key_text(const CommandKey& key) {
  constexpr char kHex[] = "0123456789ABCDEF";
  std::string text;
  for (const uint8_t byte : key.bytes) {
    text += kHex[byte >> 4];
    text += kHex[byte & 0x0F];
  }
  return text + " " + std::to_string(key.robot_id);
}

CommandKey parse_key(const std::string& text, const std::string& where) {
  CommandKey key;
  bool good = text.size() >= kDigits;
  for (size_t i = 0; good && i < key.bytes.size(); ++i) {
    good = parse(text, 2 * i, 2, 16, key.bytes.at(i));
  }
  if (good && text.size() > kDigits) {
    good = text[kDigits] == ' ' &&
           parse(text, kDigits + 1, text.size() - kDigits - 1, 10, key.robot_id);
  }
  if (!good) {
    throw InputError(where +
                     ": not a key; expected 32 hexadecimal digits, then, if it is not 1, a blank "
                     "and the robot's id (0..255)");
  }
  return key;
}

Credentials credentials_of(const CommandKey& key, uint16_t boot_epoch) {
  Credentials credentials{};
  std::copy(key.bytes.begin(), key.bytes.end(), credentials.key);
  credentials.robot_id = key.robot_id;
  credentials.key_set = true;
  credentials.boot_epoch = boot_epoch;
  return credentials;
}

CommandKey command_key_of(const Credentials& credentials) {
  CommandKey key;
  std::copy_n(credentials.key, key.bytes.size(), key.bytes.begin());
  key.robot_id = credentials.robot_id;
  return key;
}

CredentialRecord credential_record(const Credentials& credentials) {
  CredentialRecord record{};
  // A start numbers itself one above what it finds.
  put_epoch(record, static_cast<uint16_t>(credentials.boot_epoch - 1U));
  if (credentials.key_set) put_key(record, credentials.key);
  return record;
}

// Signing of commands, and the freshness they need.

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

StagedParameter stage_parameter(uint8_t node, uint16_t number, int32_t value) {
  CanFrame frame = frame_of(message::ParamStage{number, value});
  frame.id = id_of_node(frame.id, node);
  constexpr uint8_t kSignedSize = 4;  // number and lower half of the value
  const uint16_t crc = crc16_ccitt(frame.data + kE2eHeaderSize, kSignedSize);
  return {frame, static_cast<uint32_t>(number & 0xFFU) | static_cast<uint32_t>(crc) << 8U};
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
