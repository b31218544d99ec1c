#include "tools/flash/fuses.h"

#include <charconv>
#include <cstdio>

#include "host_sim/core/errors.h"

namespace screed::flash {
namespace {

bool programmed(std::uint8_t byte, unsigned bit) {
  return (byte & (1U << bit)) == 0;
}

// ATmega16U4/32U4 data sheet 7766: clock sources (chapter 6), brown-out levels (29), boot size
// (27).
std::string clock_source(std::uint8_t low) {
  const unsigned select = low & 0x0FU;
  std::string text = select >= 8   ? "crystal"
                     : select == 2 ? "internal RC oscillator"
                     : select == 0 ? "external clock"
                                   : "clock source " + std::to_string(select);
  return text + (programmed(low, 7) ? ", divided by 8" : "");
}

std::string brown_out(std::uint8_t extended) {
  static constexpr std::array<const char*, 8> kLevels = {"4.3 V", "3.5 V", "3.4 V", "2.6 V",
                                                         "2.4 V", "2.2 V", "2.0 V", "off"};
  return kLevels[extended & 7U];
}

}  // namespace

std::string hex_byte(std::uint8_t value) {
  char text[5];
  std::snprintf(text, sizeof text, "0x%02X", value);
  return text;
}

std::uint8_t parse_hex_byte(const std::string& text, const std::string& what) {
  const std::string digits = text.substr(text.starts_with("0x") || text.starts_with("0X") ? 2 : 0);
  const char* const end = digits.data() + digits.size();
  std::uint8_t value = 0;
  const auto parsed = std::from_chars(digits.data(), end, value, 16);
  if (parsed.ec != std::errc() || parsed.ptr != end)
    throw InputError(what + " '" + text + "': a byte in hexadecimal, as 0xD0");
  return value;
}

bool same(const FuseByte& fuse, const Fuses& a, const Fuses& b) {
  return ((a.*fuse.member ^ b.*fuse.member) & fuse.used_bits) == 0;
}

std::string explanation(const Fuses& fuses) {
  const unsigned boot_bytes = 4096U >> ((fuses.high >> 1) & 3U);
  char boot_start[16];
  std::snprintf(boot_start, sizeof boot_start, "0x%04X", 0x8000U - boot_bytes);
  return "low       " + hex_byte(fuses.low) + "  " + clock_source(fuses.low) + "\nhigh      " +
         hex_byte(fuses.high) + "  reset starts the " +
         (programmed(fuses.high, 0) ? std::string("bootloader at ") + boot_start : "sketch") +
         (programmed(fuses.high, 3) ? ", EEPROM survives an erase"
                                    : ", an erase clears the EEPROM") +
         (programmed(fuses.high, 6) ? ", JTAG on" : ", JTAG off (PF4 to PF7 are pins)") +
         "\nextended  " + hex_byte(fuses.extended) + "  brown-out reset " +
         brown_out(fuses.extended) + "\nlock      " + hex_byte(fuses.lock) + "  " +
         (programmed(fuses.lock, 4) ? "sketches cannot overwrite the bootloader"
                                    : "sketches can overwrite the bootloader") +
         "\n";
}

}  // namespace screed::flash
