// The key that commands are signed with, as a ground station holds it; key_file.h keeps it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "firmware/protocol/messages.h"
#include "firmware/security/key_store.h"

namespace screed {

struct CommandKey {
  std::array<uint8_t, kSipHashKeySize> bytes{};
  uint8_t robot_id = 1;

  bool operator==(const CommandKey&) const = default;
};

/// What simulated robots and ground stations use unless told otherwise: bytes 0 to 15, known to
/// everybody. Not for a robot.
CommandKey test_key();

/// "000102...0F 1" and back. Throws InputError that names `where` and what is allowed.
std::string key_text(const CommandKey& key);
CommandKey parse_key(const std::string& text, const std::string& where);

/// The first start in which a robot can have a key: it was set in the one before.
constexpr uint16_t kFirstBootEpoch = 2;

/// As a robot that has it holds it, in its start number boot_epoch.
Credentials credentials_of(const CommandKey& key, uint16_t boot_epoch = kFirstBootEpoch);
/// The key of a robot.
CommandKey command_key_of(const Credentials& credentials);
/// The EEPROM of that robot, before this start.
CredentialRecord credential_record(const Credentials& credentials);

// Makes COMMAND frames that a robot accepts: holds the key, and follows the robot's freshness.
//
//   CommandSigner signer(read_key_file(file));
//   for every frame received:  signer.handle_frame(frame);
//   if (signer.ready())        send(signer.sign(CommandOp::kArm));
//
// A command that was not answered is sent again as the same frame: the robot does it once and
// answers every time. Commands go at most four times a second.

/// The 24 bits of a command whose argument is that of a drive or a position fix.
uint32_t command_argument(const DriveArgument& argument);

/// A new value of a parameter, as a robot takes it: a frame, not yet protected, and the argument of
/// CommandOp::kParameterCommit, which follows it.
struct StagedParameter {
  CanFrame frame;
  uint32_t argument;
};
StagedParameter stage_parameter(uint8_t node, uint16_t number, int32_t value);

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
