// Heads of states, little-endian.
#include "host_sim/core/state_bytes.h"

#include <cstddef>

#include "host_sim/core/errors.h"

namespace screed {
namespace {

constexpr std::string_view kMark = "screed  ";
constexpr size_t kNameBytes = 8;
constexpr size_t kVersionBytes = 4;
constexpr size_t kSumBytes = 8;
constexpr size_t kHeadBytes = kMark.size() + kNameBytes + kVersionBytes + kSumBytes;

uint64_t checksum(std::string_view bytes) {
  uint64_t sum = 0xCBF29CE484222325U;
  for (const char byte : bytes) sum = (sum ^ static_cast<uint8_t>(byte)) * 0x100000001B3U;
  return sum;
}

std::string number_bytes(uint64_t number, size_t size) {
  std::string bytes;
  for (size_t i = 0; i < size; ++i) bytes += static_cast<char>(number >> (8 * i) & 0xFFU);
  return bytes;
}

uint64_t number_in(std::string_view bytes) {
  uint64_t number = 0;
  for (size_t i = bytes.size(); i-- > 0;) number = number << 8U | static_cast<uint8_t>(bytes[i]);
  return number;
}

std::string padded(std::string_view name) {
  std::string bytes(name);
  bytes.resize(kNameBytes, ' ');
  return bytes;
}

}  // namespace

std::string with_head(const StateName& name, std::string_view bytes) {
  std::string state(kMark);
  state += padded(name.name);
  state += number_bytes(name.version, kVersionBytes);
  state += number_bytes(checksum(bytes), kSumBytes);
  state += bytes;
  return state;
}

std::string_view without_head(const StateName& name, std::string_view state) {
  const std::string what(name.name);
  const InputError damaged("state of a " + what + ": damaged, or of something else");
  if (state.size() < kHeadBytes) throw damaged;
  const std::string_view rest = state.substr(kHeadBytes);
  const std::string_view its_name = state.substr(kMark.size(), kNameBytes);
  const std::string_view version = state.substr(kMark.size() + kNameBytes, kVersionBytes);
  const std::string_view sum = state.substr(kHeadBytes - kSumBytes, kSumBytes);
  if (!state.starts_with(kMark) || its_name != padded(name.name) ||
      number_in(sum) != checksum(rest))
    throw damaged;
  if (number_in(version) != name.version) {
    throw InputError("state of a " + what + " of version " + std::to_string(number_in(version)) +
                     "; allowed: " + std::to_string(name.version));
  }
  return rest;
}

}  // namespace screed
