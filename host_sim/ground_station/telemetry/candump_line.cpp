#include "host_sim/ground_station/telemetry/candump_line.h"

#include <cstdio>
#include <cstring>

namespace screed {
namespace {

constexpr uint8_t kNotHex = 0xFF;

constexpr struct HexTable {
  uint8_t value[256];
} kHex = [] {
  HexTable table{};
  for (unsigned i = 0; i < 256; ++i) {
    const unsigned lower = i | 0x20U;
    table.value[i] = i >= '0' && i <= '9'           ? static_cast<uint8_t>(i - '0')
                     : lower >= 'a' && lower <= 'f' ? static_cast<uint8_t>(lower - 'a' + 10)
                                                    : kNotHex;
  }
  return table;
}();

uint8_t hex_value(char digit) {
  return kHex.value[static_cast<uint8_t>(digit)];
}

/// Takes decimal digits off the front; false when there are none, or too many for a number.
bool take_number(std::string_view& text, size_t most_digits, uint64_t& value) {
  size_t digits = 0;
  value = 0;
  while (digits < text.size() && text[digits] >= '0' && text[digits] <= '9') {
    if (++digits > most_digits) return false;
    value = value * 10 + static_cast<uint64_t>(text[digits - 1] - '0');
  }
  text.remove_prefix(digits);
  return digits > 0;
}

bool take(std::string_view& text, char wanted) {
  if (text.empty() || text.front() != wanted) return false;
  text.remove_prefix(1);
  return true;
}

/// Digits up to a sign that is none.
size_t hex_digits(std::string_view text) {
  size_t count = 0;
  while (count < text.size() && hex_value(text[count]) != kNotHex) ++count;
  return count;
}

}  // namespace

std::string candump_line(uint64_t time_us, std::string_view interface, const CanFrame& frame) {
  constexpr char kDigits[] = "0123456789ABCDEF";
  char time[40];
  std::snprintf(time, sizeof time, "(%010llu.%06llu) ",
                static_cast<unsigned long long>(time_us / 1000000U),
                static_cast<unsigned long long>(time_us % 1000000U));
  std::string line = time;
  line += interface;
  line += ' ';
  for (const unsigned shift : {8U, 4U, 0U}) line += kDigits[(frame.id >> shift) & 0xFU];
  line += '#';
  for (uint8_t i = 0; i < frame.size; ++i) {
    line += kDigits[frame.data[i] >> 4U];
    line += kDigits[frame.data[i] & 0xFU];
  }
  line += '\n';
  return line;
}

LineKind parse_candump_line(std::string_view line, LoggedFrame& frame) {
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  uint64_t seconds = 0;
  uint64_t micros = 0;
  if (!take(line, '(') || !take_number(line, 12, seconds) || !take(line, '.')) {
    return LineKind::kUnreadable;
  }
  const size_t before = line.size();
  if (!take_number(line, 6, micros) || before - line.size() != 6 || !take(line, ')') ||
      !take(line, ' ')) {
    return LineKind::kUnreadable;
  }
  const size_t name = line.find(' ');
  if (name == 0 || name == std::string_view::npos || name > 15) return LineKind::kUnreadable;
  line.remove_prefix(name + 1);
  // Newer versions end a line with " R" or " T": received, transmitted.
  if (line.ends_with(" R") || line.ends_with(" T")) line.remove_suffix(2);

  const size_t id_digits = hex_digits(line);
  if ((id_digits != 3 && id_digits != 8) || line.size() < id_digits + 1 || line[id_digits] != '#') {
    return LineKind::kUnreadable;
  }
  uint32_t id = 0;
  for (size_t i = 0; i < id_digits; ++i) id = id << 4U | hex_value(line[i]);
  line.remove_prefix(id_digits + 1);
  if (id_digits == 8 || line.starts_with('#') || line.starts_with('R')) {
    // The rest of such a line is hexadecimal as well: flags, a size, data.
    const size_t sign = line.empty() || hex_value(line.front()) != kNotHex ? 0 : 1;
    return hex_digits(line.substr(sign)) + sign == line.size() ? LineKind::kOtherFrame
                                                               : LineKind::kUnreadable;
  }
  if (id > 0x7FFU || line.size() > 16 || line.size() % 2 != 0) return LineKind::kUnreadable;
  frame.time_us = seconds * 1000000U + micros;
  frame.frame.id = static_cast<uint16_t>(id);
  frame.frame.size = static_cast<uint8_t>(line.size() / 2);
  std::memset(frame.frame.data, 0, sizeof frame.frame.data);
  uint8_t wrong = 0;
  for (size_t i = 0; i < line.size(); i += 2) {
    const uint8_t high = hex_value(line[i]);
    const uint8_t low = hex_value(line[i + 1]);
    wrong = static_cast<uint8_t>(wrong | high | low);
    frame.frame.data[i / 2] = static_cast<uint8_t>(high << 4U | low);
  }
  return (wrong & 0xF0U) == 0 ? LineKind::kFrame : LineKind::kUnreadable;
}

}  // namespace screed
