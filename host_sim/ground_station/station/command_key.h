// The key that commands are signed with, as a ground station holds it; key_file.h keeps it.
#pragma once

#include <array>
#include <cstdint>
#include <string>

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

}  // namespace screed
