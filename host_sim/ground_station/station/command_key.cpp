#include "host_sim/ground_station/station/command_key.h"

#include <algorithm>
#include <charconv>
#include <numeric>

#include "host_sim/core/errors.h"

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

}  // namespace screed
