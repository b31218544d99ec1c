// Bytes as text that every document takes.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace screed {

/// Base64 with padding, in one line (RFC 4648, section 4).
std::string base64(std::span<const std::uint8_t> bytes);

}  // namespace screed
