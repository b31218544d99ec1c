#include "host_sim/ground_station/telemetry/candump_line.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <optional>

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

void skip_spaces(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
}

/// Days from 1970-01-01 to a date of the Gregorian calendar.
std::optional<int64_t> days_to(uint64_t year, uint64_t month, uint64_t day) {
  const std::chrono::year_month_day date(std::chrono::year(static_cast<int>(year)),
                                         std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day)));
  if (!date.ok()) return std::nullopt;
  return std::chrono::sys_days(date).time_since_epoch().count();
}

/// "2020-08-13 04:59:22" as candump -tA writes it, behind "2020": the time since 1970, were it UTC.
bool take_date(std::string_view& text, uint64_t year, uint64_t& seconds) {
  uint64_t part[5] = {};  // month, day, hour, minute, second
  constexpr char kBefore[5] = {'-', '-', ' ', ':', ':'};
  for (size_t i = 0; i < 5; ++i) {
    if (!take(text, kBefore[i]) || !take_number(text, 2, part[i])) return false;
  }
  const std::optional<int64_t> days = days_to(year, part[0], part[1]);
  if (!days.has_value() || *days < 0 || part[2] > 23 || part[3] > 59 || part[4] > 60) return false;
  seconds = ((static_cast<uint64_t>(*days) * 24 + part[2]) * 60 + part[3]) * 60 + part[4];
  return true;
}

/// "(1436509052.249713)", with nine digits of a second (-N) or a date (-tA) as well.
bool take_time(std::string_view& text, uint64_t& time_us) {
  uint64_t seconds = 0;
  if (!take(text, '(') || !take_number(text, 12, seconds)) return false;
  if (text.starts_with('-') && !take_date(text, seconds, seconds)) return false;
  uint64_t fraction = 0;
  if (!take(text, '.')) return false;
  const size_t before = text.size();
  if (!take_number(text, 9, fraction)) return false;
  const size_t digits = before - text.size();
  if ((digits != 6 && digits != 9) || !take(text, ')') || !text.starts_with(' ')) return false;
  time_us = seconds * 1000000U + (digits == 9 ? fraction / 1000U : fraction);
  return true;
}

/// The data of a frame in hexadecimal, two digits a byte and nothing between.
bool set_data(std::string_view hex, CanFrame& frame) {
  frame.size = static_cast<uint8_t>(hex.size() / 2);
  std::memset(frame.data, 0, sizeof frame.data);
  uint8_t wrong = 0;
  for (size_t i = 0; i < hex.size(); i += 2) {
    const uint8_t high = hex_value(hex[i]);
    const uint8_t low = hex_value(hex[i + 1]);
    wrong = static_cast<uint8_t>(wrong | high | low);
    frame.data[i / 2] = static_cast<uint8_t>(high << 4U | low);
  }
  return (wrong & 0xF0U) == 0;
}

/// Behind the id of a line for people: "   [3]  2A 36 6C", with -a also "  '*6l'".
LineKind parse_columns(std::string_view text, bool short_id, CanFrame& frame) {
  uint64_t size = 0;
  skip_spaces(text);
  if (!take(text, '[') || !take_number(text, 2, size) || !take(text, ']')) {
    return LineKind::kUnreadable;
  }
  if (!short_id || size > sizeof frame.data || text.ends_with("remote request")) {
    return LineKind::kOtherFrame;
  }
  char hex[2 * sizeof frame.data] = {};
  for (size_t i = 0; i < size; ++i) {
    skip_spaces(text);
    if (text.size() < 2 || (text.size() > 2 && text[2] != ' ')) return LineKind::kUnreadable;
    std::memcpy(hex + 2 * i, text.data(), 2);
    text.remove_prefix(2);
  }
  skip_spaces(text);
  const bool good = (text.empty() || text.front() == '\'') && set_data({hex, 2 * size}, frame);
  return good ? LineKind::kFrame : LineKind::kUnreadable;
}

/// Behind the id of a line for files: "#2A366C".
LineKind parse_compact(std::string_view text, bool short_id, CanFrame& frame) {
  // Newer versions end a line with " R" or " T": received, transmitted.
  if (text.ends_with(" R") || text.ends_with(" T")) text.remove_suffix(2);
  text.remove_prefix(1);
  if (!short_id || text.starts_with('#') || text.starts_with('R')) {
    // The rest of such a line is hexadecimal as well: flags, a size, data.
    const size_t sign = text.empty() || hex_value(text.front()) != kNotHex ? 0 : 1;
    return hex_digits(text.substr(sign)) + sign == text.size() ? LineKind::kOtherFrame
                                                               : LineKind::kUnreadable;
  }
  if (text.size() > 2 * sizeof frame.data || text.size() % 2 != 0 || !set_data(text, frame)) {
    return LineKind::kUnreadable;
  }
  return LineKind::kFrame;
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
  skip_spaces(line);
  const bool timed = line.starts_with('(');
  if (timed && !take_time(line, frame.time_us)) return LineKind::kUnreadable;
  skip_spaces(line);
  constexpr size_t kLongestName = 15;
  const size_t name = line.find(' ');
  if (name == 0 || name > kLongestName) return LineKind::kUnreadable;
  line.remove_prefix(name);
  skip_spaces(line);
  // With -x lines for people say so here: received, broadcast, error.
  constexpr std::string_view kFlags = "RX - -";
  if (line.size() > kFlags.size() && line.substr(1, 2) == "X ") line.remove_prefix(kFlags.size());
  skip_spaces(line);

  const size_t id_digits = hex_digits(line);
  if ((id_digits != 3 && id_digits != 8) || line.size() == id_digits) return LineKind::kUnreadable;
  uint32_t id = 0;
  for (size_t i = 0; i < id_digits; ++i) id = id << 4U | hex_value(line[i]);
  line.remove_prefix(id_digits);
  const bool short_id = id_digits == 3;
  if (short_id && id > 0x7FFU) return LineKind::kUnreadable;
  frame.frame.id = static_cast<uint16_t>(id);
  if (line.front() == '#') {
    return timed ? parse_compact(line, short_id, frame.frame) : LineKind::kUnreadable;
  }
  const LineKind kind = parse_columns(line, short_id, frame.frame);
  return kind == LineKind::kFrame && !timed ? LineKind::kUntimed : kind;
}

}  // namespace screed
