// The messages as tables for programs that show, decode or plot any of them: names, places, units,
// scales, names of values. Made from firmware/protocol/screed.dbc; for the host only.
//
// An id carries the node (robot) that it belongs to; the tables hold the ids of node 1, and the
// functions here take those of any robot.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/protocol/node.h"
#include "firmware/protocol/slcan.h"

namespace screed {

struct ValueInfo {
  uint32_t value;
  const char* name;
};

/// The 8 bytes of a message as one number, for SignalInfo::raw().
uint64_t message_bits(const uint8_t* data);

enum class SignalRole : uint8_t { kData, kCrc, kCounter };

struct SignalInfo {
  const char* name;
  const char* unit;     ///< empty: names of values, flags
  const char* flags;    ///< the field that this flag is a bit of; empty: no flag
  const char* comment;  ///< may be empty
  SignalRole role;
  uint8_t start;   ///< lowest bit
  uint8_t length;  ///< bits, 1..32
  bool is_signed;
  uint8_t decimals;  ///< value = (raw * scale + offset) / 10^decimals, exactly
  int64_t scale;
  int64_t offset;
  std::span<const ValueInfo> values;  ///< names of values; empty: a number

  /// The bits as a number. data has 8 bytes.
  [[nodiscard]] int64_t raw(const uint8_t* data) const;
  [[nodiscard]] int64_t raw(uint64_t bits) const;  ///< of the 8 bytes as one number
  /// In its unit.
  [[nodiscard]] double value(int64_t raw) const;
  /// The name of a value; null when it has none.
  [[nodiscard]] const char* value_name(int64_t raw) const;
  /// As people read it: the name of the value, or the number with all its decimals; no unit.
  [[nodiscard]] std::string text(int64_t raw) const;
  /// The same with as many decimals as the signal's steps have, and with its unit: "20.000 degC",
  /// "1 count", "130 counts".
  [[nodiscard]] std::string shown(int64_t raw) const;
};

struct MessageInfo {
  const char* name;
  const char* title;  ///< the name in small letters
  const char* comment;
  uint16_t id;         ///< of node 0 or 1
  uint8_t size;        ///< bytes
  uint16_t period_ms;  ///< 0: no period
  bool uplink;         ///< sent by the ground
  bool protected_by_crc;
  std::span<const SignalInfo> signals;

  /// The signal of a name; null when there is none.
  [[nodiscard]] const SignalInfo* signal(std::string_view name) const;
};

/// All messages, in the order of the schema.
std::span<const MessageInfo> messages();

/// The message of an id, of any robot; null when there is none.
const MessageInfo* find_message(uint16_t id);

/// The message of a name, in capitals or small letters; null when there is none.
const MessageInfo* find_message(std::string_view name);

/// A signal by "message.signal", as "attitude.pitch". Throws InputError that names what there is.
struct SignalRef {
  const MessageInfo* message;
  const SignalInfo* signal;
};
SignalRef find_signal(std::string_view path);

/// The names of a signal's values, in the order of the schema: value_names("leveling.algorithm").
/// Throws as find_signal.
std::vector<std::string> value_names(std::string_view path);

/// A flag and its bit in the field that it belongs to.
struct FlagInfo {
  const SignalInfo* signal;
  uint32_t bit;
};
/// The flags of a field, lowest bit first: flags_of("heartbeat", "faults"). Throws InputError when
/// there is no such message; empty when it has no such field.
std::vector<FlagInfo> flags_of(std::string_view message, std::string_view field);

/// A name of the schema as people write it: "stall left" for "stall_left".
std::string display_name(std::string_view name);
/// A flag's display name and meaning: "stall left: high duty, no motion".
std::string flag_text(const SignalInfo& flag);

/// The names of the set bits of a field of flags, in their order, with ", " between them:
/// flag_names("heartbeat", "faults", 5) is "tilt, gyro_frozen"; empty: none. Bits without a name
/// are passed over. Throws InputError when there is no such message.
std::string flag_names(std::string_view message, std::string_view field, uint32_t bits);

/// What is wrong with a frame.
enum class FrameFault : uint8_t {
  kNone,
  kUnknownId,
  kWrongSize,  ///< not the size that the schema says
  kWrongCrc,
  kWrongWay,  ///< a message of the ground's where a robot's was to come, or the other way round
};

/// Checks a frame against the schema. The MAC of an authenticated message is not looked at.
FrameFault check_frame(const CanFrame& frame);

/// The rule for what comes from the radio. uplink: it comes from the ground. The way matters: a
/// COMMAND has no CRC, so a wrong bit in its id could else make a message of a robot of it.
FrameFault check_received(const CanFrame& frame, bool uplink);

}  // namespace screed
