// Bytes that other programs keep for us: what stands before them, so that damaged and foreign ones
// are refused.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace screed {

struct StateName {
  std::string_view name;  ///< of what it is a state, at most 8 characters
  uint32_t version;
};

/// The bytes with a head: "screed", name, version, and a checksum of them (FNV-1a, 64 bits).
std::string with_head(const StateName& name, std::string_view bytes);

/// What comes after the head. Throws InputError for what is damaged, of something else or of
/// another version.
std::string_view without_head(const StateName& name, std::string_view state);

}  // namespace screed
