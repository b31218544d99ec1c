// The fuse and lock bytes of the ATmega32U4. Knows no programmer.
#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace screed::flash {

struct Fuses {
  std::uint8_t low = 0xFF;
  std::uint8_t high = 0xFF;
  std::uint8_t extended = 0xFF;
  std::uint8_t lock = 0xFF;
};

struct FuseByte {
  const char* name;
  const char* avrdude_name;
  std::uint8_t Fuses::*member;
  /// The bits that exist (ATmega16U4/32U4 data sheet 7766, chapter 28). The others read as 1,
  /// whatever is written.
  std::uint8_t used_bits;
};

/// In the order in which they are written: the lock byte last.
inline constexpr std::array<FuseByte, 4> kFuseBytes = {{
    {"low", "lfuse", &Fuses::low, 0xFF},
    {"high", "hfuse", &Fuses::high, 0xFF},
    {"extended", "efuse", &Fuses::extended, 0x0F},
    {"lock", "lock", &Fuses::lock, 0x3F},
}};

/// "0xD0"
std::string hex_byte(std::uint8_t value);

/// The inverse, with or without 0x. Throws InputError naming `what`.
std::uint8_t parse_hex_byte(const std::string& text, const std::string& what);

/// Whether the bits that exist are alike.
bool same(const FuseByte& fuse, const Fuses& a, const Fuses& b);

/// What the values mean, a line each.
std::string explanation(const Fuses& fuses);

}  // namespace screed::flash
