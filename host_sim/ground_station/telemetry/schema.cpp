// Lookup in the schema's tables.
#include "host_sim/ground_station/telemetry/schema.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "firmware/protocol/e2e.h"
#include "host_sim/core/errors.h"
#include "schema/tables.h"

namespace screed {
namespace {

using namespace schema_tables;  // made for this file alone

/// The message of every id, as its place in the table plus 1.
constexpr std::array<uint8_t, 2048> kById = [] {
  static_assert(std::size(kMessages) < 255);
  std::array<uint8_t, 2048> table{};
  for (size_t i = 0; i < std::size(kMessages); ++i) {
    const uint16_t id = kMessages[i].id;
    table[id] = static_cast<uint8_t>(i + 1);
    for (unsigned node = 1; node < 16 && node_of(id) != 0; ++node) {
      table[id_of_node(id, static_cast<uint8_t>(node))] = static_cast<uint8_t>(i + 1);
    }
  }
  return table;
}();

std::string list_of(std::span<const char* const> names) {
  std::string text;
  for (const char* name : names) text += (text.empty() ? "" : ", ") + std::string(name);
  return text;
}

/// As find_message(), but InputError says what there is. path: what was asked for.
const MessageInfo& message_of(std::string_view name, std::string_view path) {
  const MessageInfo* const message = find_message(name);
  if (message != nullptr) return *message;
  std::vector<const char*> names;
  for (const MessageInfo& it : kMessages) names.push_back(it.title);
  throw InputError(std::string(path) + ": no message of this name; there are " + list_of(names));
}

}  // namespace

int64_t SignalInfo::raw(uint64_t bits) const {
  const uint64_t field = (bits >> start) & ((uint64_t{1} << length) - 1);
  if (!is_signed) return static_cast<int64_t>(field);
  const uint64_t sign = uint64_t{1} << (length - 1);
  return static_cast<int64_t>(field ^ sign) - static_cast<int64_t>(sign);
}

uint64_t message_bits(const uint8_t* data) {
  uint64_t bits = 0;
  for (unsigned i = 0; i < 8; ++i) bits |= static_cast<uint64_t>(data[i]) << (8 * i);
  return bits;
}

int64_t SignalInfo::raw(const uint8_t* data) const {
  return raw(message_bits(data));
}

double SignalInfo::value(int64_t raw) const {
  constexpr double kPowers[] = {1, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9};
  return static_cast<double>(raw * scale + offset) / kPowers[decimals];
}

const char* SignalInfo::value_name(int64_t raw) const {
  for (const ValueInfo& it : values) {
    if (it.value == raw) return it.name;
  }
  return nullptr;
}

namespace {

/// number / 10^decimals, with all its digits.
std::string decimal_text(int64_t number, size_t decimals) {
  std::string digits = std::to_string(std::abs(number));
  if (digits.size() <= decimals) digits.insert(0, decimals + 1U - digits.size(), '0');
  if (decimals > 0) digits.insert(digits.size() - decimals, ".");
  return (number < 0 ? "-" : "") + digits;
}

}  // namespace

std::string SignalInfo::text(int64_t raw) const {
  const char* const named = value_name(raw);
  return named != nullptr ? named : decimal_text(raw * scale + offset, decimals);
}

std::string SignalInfo::shown(int64_t raw) const {
  std::string shown = text(raw);
  if (value_name(raw) == nullptr) {
    size_t kept = decimals;
    int64_t step = 1;  // in the last digit that is kept; at most as large as the signal's
    for (; kept > 0 && step * 10 <= scale; --kept) step *= 10;
    const int64_t number = raw * scale + offset;
    const int64_t half = number < 0 ? -step / 2 : step / 2;
    shown = decimal_text((number + half) / step, kept);
  }
  if (unit[0] == '\0') return shown;
  const bool several = std::string_view(unit) == "count" && shown != "1";
  return shown.append(" ").append(unit).append(several ? "s" : "");
}

const SignalInfo* MessageInfo::signal(std::string_view wanted) const {
  for (const SignalInfo& it : signals) {
    if (it.name == wanted) return &it;
  }
  return nullptr;
}

std::span<const MessageInfo> messages() {
  return kMessages;
}

const MessageInfo* find_message(uint16_t id) {
  if (id >= kById.size() || kById[id] == 0) return nullptr;
  return &kMessages[kById[id] - 1U];
}

const MessageInfo* find_message(std::string_view name) {
  for (const MessageInfo& it : kMessages) {
    if (it.name == name || it.title == name) return &it;
  }
  return nullptr;
}

SignalRef find_signal(std::string_view path) {
  const size_t point = path.find('.');
  const MessageInfo& message = message_of(path.substr(0, point), path);
  const SignalInfo* const signal =
      point == std::string_view::npos ? nullptr : message.signal(path.substr(point + 1));
  if (signal == nullptr) {
    std::vector<const char*> names;
    for (const SignalInfo& it : message.signals) names.push_back(it.name);
    throw InputError(std::string(path) + ": no signal of this name; " + message.title + " has " +
                     list_of(names));
  }
  return {&message, signal};
}

std::vector<std::string> value_names(std::string_view path) {
  std::vector<std::string> names;
  for (const ValueInfo& it : find_signal(path).signal->values) names.emplace_back(it.name);
  return names;
}

std::vector<FlagInfo> flags_of(std::string_view message, std::string_view field) {
  std::vector<FlagInfo> flags;
  for (const SignalInfo& it : message_of(message, message).signals) {
    if (it.flags == field) flags.push_back({&it, 0});
  }
  std::sort(flags.begin(), flags.end(),
            [](const FlagInfo& a, const FlagInfo& b) { return a.signal->start < b.signal->start; });
  for (FlagInfo& it : flags) it.bit = 1U << (it.signal->start - flags.front().signal->start);
  return flags;
}

std::string display_name(std::string_view name) {
  std::string words(name);
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

std::string flag_text(const SignalInfo& flag) {
  const std::string name = display_name(flag.name);
  return flag.comment[0] == '\0' ? name : name + ": " + flag.comment;
}

std::string flag_names(std::string_view message, std::string_view field, uint32_t bits) {
  std::vector<const char*> names;
  for (const FlagInfo& it : flags_of(message, field)) {
    if ((bits & it.bit) != 0) names.push_back(it.signal->name);
  }
  return list_of(names);
}

FrameFault check_frame(const CanFrame& frame) {
  const MessageInfo* const message = find_message(frame.id);
  if (message == nullptr) return FrameFault::kUnknownId;
  if (frame.size != message->size) return FrameFault::kWrongSize;
  if (message->protected_by_crc && !e2e_check(frame.id, frame.data, frame.size)) {
    return FrameFault::kWrongCrc;
  }
  return FrameFault::kNone;
}

FrameFault check_received(const CanFrame& frame, bool uplink) {
  const MessageInfo* const message = find_message(frame.id);
  if (message != nullptr && message->uplink != uplink) return FrameFault::kWrongWay;
  return check_frame(frame);
}

}  // namespace screed
