// The rules of the schema.
#include "tools/schema/schema_check.h"

#include <algorithm>
#include <array>
#include <set>
#include <string_view>

#include "host_sim/core/errors.h"

namespace screed::schema {
namespace {

// What C++, shells and column names take as it is. Decoders differ in what they do with the rest.
bool plain_name(const std::string& name, bool capitals) {
  const auto letter = [&](char c) {
    return capitals ? c >= 'A' && c <= 'Z' : c >= 'a' && c <= 'z';
  };
  return !name.empty() && name.size() <= 32 && letter(name[0]) && name.back() != '_' &&
         name.find("__") == std::string::npos && std::all_of(name.begin(), name.end(), [&](char c) {
           return letter(c) || c == '_' || (c >= '0' && c <= '9');
         });
}

/// Words of C++ and of the generated code.
constexpr std::string_view kReserved[] = {
    "and",    "auto",     "bool",   "break",   "case",   "char",     "class",  "const",  "continue",
    "data",   "default",  "delete", "do",      "double", "else",     "enum",   "export", "extern",
    "false",  "float",    "for",    "goto",    "if",     "inline",   "int",    "long",   "new",
    "not",    "or",       "pack",   "private", "public", "register", "return", "short",  "signed",
    "sizeof", "static",   "struct", "switch",  "this",   "throw",    "true",   "try",    "union",
    "unpack", "unsigned", "using",  "virtual", "void",   "volatile", "while",  "xor"};

bool is_reserved(const std::string& name) {
  return std::find(std::begin(kReserved), std::end(kReserved), name) != std::end(kReserved);
}

bool plain_text(const std::string& text) {
  return std::all_of(text.begin(), text.end(),
                     [](char c) { return c >= ' ' && c <= '~' && c != '"' && c != '\\'; });
}

class Checker {
 public:
  explicit Checker(const Database& database) : database_(database) {}

  void check() {
    if (database_.messages.empty()) fail(1, "there is no message (BO_) in it");
    std::set<std::uint32_t> ids;
    std::set<std::string> names;
    for (const DbcMessage& message : database_.messages) {
      check(message);
      if (!ids.insert(message.id).second) {
        fail(message.line, message.name + ": id " + std::to_string(message.id) + " is taken");
      }
      if (!names.insert(message.name).second) {
        fail(message.line, "the name " + message.name + " is taken");
      }
    }
  }

 private:
  [[noreturn]] void fail(int line, const std::string& what) const {
    throw InputError(database_.file + ":" + std::to_string(line) + ": " + what);
  }

  void check(const DbcMessage& message) const {
    const std::string& name = message.name;
    const auto refuse = [&](const std::string& what) { fail(message.line, name + ": " + what); };
    if (!plain_name(name, true)) {
      refuse("names of messages are capitals, digits and single underscores, at most 32");
    }
    if ((message.id & 0x80000000U) != 0) refuse("an extended id; ids have 11 bits");
    if (message.id > 0x7FFU) refuse("id " + std::to_string(message.id) + " is above 2047");
    const unsigned node = (message.id >> 4) & 0xFU;
    if (node > 1) {
      refuse("bits 4 to 7 of the id are the node: 0 for the ground, 1 for the robot, not " +
             std::to_string(node));
    }
    if (message.size < 1 || message.size > 8) {
      refuse(std::to_string(message.size) + " bytes; a frame holds 1 to 8");
    }
    if (std::find(database_.nodes.begin(), database_.nodes.end(), message.sender) ==
        database_.nodes.end()) {
      refuse("its sender " + message.sender + " is not among the nodes (BU_)");
    }
    if (message.comment.empty()) refuse("has no comment (CM_ BO_)");
    if (!plain_text(message.comment)) refuse("its comment is not plain ASCII on one line");
    if (message.signals.empty()) refuse("has no signal");
    if (message.protected_by_crc()) check_protection(message);
    check_signals(message);
    check_flags(message);
  }

  void check_protection(const DbcMessage& message) const {
    if (message.size < 3) {
      fail(message.line, message.name + ": a protected message has 3 bytes or more");
    }
    check_protection(message, "crc", 0, 8);
    check_protection(message, "counter", 8, 4);
  }

  void check_protection(const DbcMessage& message, const std::string& name, int start,
                        int length) const {
    const auto found = std::find_if(message.signals.begin(), message.signals.end(),
                                    [&](const DbcSignal& it) { return it.name == name; });
    const std::string place =
        name + " : " + std::to_string(start) + "|" + std::to_string(length) + "@1+ (1,0)";
    if (found == message.signals.end()) {
      fail(message.line, message.name + ": a protected message has the signal " + place +
                             "; or set its attribute Protection to mac");
    }
    if (found->start != start || found->length != length || found->is_signed ||
        found->scale.value() != 1.0 || found->offset.mantissa != 0) {
      fail(found->line, message.name + ": its protection is " + place);
    }
  }

  void check_signals(const DbcMessage& message) const {
    std::set<std::string> names;
    std::array<const DbcSignal*, 64> owner{};
    for (const DbcSignal& signal : message.signals) {
      check(message, signal);
      const std::string place = message.name + "." + signal.name;
      if (!names.insert(signal.name).second) fail(signal.line, "the name " + place + " is taken");
      if (signal.start + signal.length > 8 * message.size) {
        fail(signal.line, place + ": ends at bit " + std::to_string(signal.start + signal.length) +
                              ", the message has " + std::to_string(8 * message.size));
      }
      for (int bit = signal.start; bit < signal.start + signal.length; ++bit) {
        const DbcSignal*& other = owner[static_cast<size_t>(bit)];
        if (other != nullptr) {
          fail(signal.line, place + ": overlaps " + other->name + " at bit " + std::to_string(bit));
        }
        other = &signal;
      }
    }
  }

  void check(const DbcMessage& message, const DbcSignal& signal) const {
    const auto refuse = [&](const std::string& what) {
      fail(signal.line, message.name + "." + signal.name + ": " + what);
    };
    if (!plain_name(signal.name, false)) {
      refuse("names of signals are small letters, digits and single underscores, at most 32");
    }
    if (is_reserved(signal.name)) {
      refuse("is a word of C++ or of the generated code");
    }
    if (!signal.multiplexer.empty()) {
      refuse("multiplexed (" + signal.multiplexer +
             "); decoders disagree on it: make it a message of its own");
    }
    if (!signal.little_endian) {
      refuse("big endian (@0); decoders count its bits differently: use little endian (@1)");
    }
    if (signal.is_float) refuse("a floating point value; use an integer with a scale");
    if (signal.length > 32) refuse("has " + std::to_string(signal.length) + " bits; 1 to 32");
    if (signal.is_signed && signal.length != 8 && signal.length != 16 && signal.length != 32) {
      refuse("signed with " + std::to_string(signal.length) +
             " bits; decoders extend only 8, 16 and 32 alike");
    }
    check_numbers(message, signal);
    check_values(message, signal);
    check_classes(message, signal);
    if (!plain_text(signal.comment)) refuse("its comment is not plain ASCII on one line");
    if (!plain_text(signal.unit) || signal.unit.find(',') != std::string::npos) {
      refuse("its unit is not plain ASCII without commas");
    }
    const bool unitless =
        !signal.values.empty() || !signal.flags().empty() || is_protection(message, signal);
    if (signal.unit.empty() && !unitless) {
      refuse("has no unit; a pure number has the unit \"1\"");
    }
    if (!signal.unit.empty() && unitless) refuse("names of values and flags have no unit");
  }

  void check_numbers(const DbcMessage& message, const DbcSignal& signal) const {
    const auto refuse = [&](const std::string& what) {
      fail(signal.line, message.name + "." + signal.name + ": " + what);
    };
    if (signal.scale.mantissa <= 0) refuse("its scale is not positive");
    if (signal.scale.decimals > 9 || signal.offset.decimals > 9 ||
        signal.scale.mantissa > 1000000000 || std::abs(signal.offset.mantissa) > 1000000000) {
      refuse("scale and offset have at most 9 digits");
    }
    const auto bits = static_cast<unsigned>(signal.length);
    const std::int64_t least_raw = signal.is_signed ? -(std::int64_t{1} << (bits - 1)) : 0;
    const std::int64_t most_raw = (std::int64_t{1} << (signal.is_signed ? bits - 1 : bits)) - 1;
    const double scale = signal.scale.value();
    const double offset = signal.offset.value();
    const double slack = scale * 1e-6;
    if (signal.minimum.value() >= signal.maximum.value()) {
      refuse("its range [" + signal.minimum.text() + "|" + signal.maximum.text() + "] is empty");
    }
    if (signal.minimum.value() < static_cast<double>(least_raw) * scale + offset - slack ||
        signal.maximum.value() > static_cast<double>(most_raw) * scale + offset + slack) {
      refuse("its range [" + signal.minimum.text() + "|" + signal.maximum.text() +
             "] does not fit into " + std::to_string(signal.length) + " bits");
    }
  }

  void check_values(const DbcMessage& message, const DbcSignal& signal) const {
    if (signal.values.empty()) return;
    const std::string place = message.name + "." + signal.name;
    if (signal.is_signed || signal.scale.value() != 1.0 || signal.offset.mantissa != 0) {
      fail(signal.line, place + ": has names of values; then it is unsigned with scale (1,0)");
    }
    std::set<std::int64_t> numbers;
    std::set<std::string> names;
    for (const ValueName& value : signal.values) {
      if (value.value < 0 || value.value >= std::int64_t{1} << signal.length) {
        fail(value.line, place + ": the value " + std::to_string(value.value) +
                             " does not fit into " + std::to_string(signal.length) + " bits");
      }
      if (!plain_name(value.name, false)) {
        fail(value.line, place + ": '" + value.name +
                             "': names of values are small letters, digits and single underscores");
      }
      if (!numbers.insert(value.value).second || !names.insert(value.name).second) {
        fail(value.line,
             place + ": " + std::to_string(value.value) + " \"" + value.name + "\" is there twice");
      }
    }
  }

  /// The folder and the names become part of an #include line, the names of a C++ class as well.
  void check_classes(const DbcMessage& message, const DbcSignal& signal) const {
    const std::string folder = signal.class_folder();
    if (folder.empty()) return;
    const std::string place = message.name + "." + signal.name;
    if (signal.values.empty()) {
      fail(signal.line, place + ": has the attribute ClassFolder, but no names of values (VAL_)");
    }
    if (folder.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_/") != std::string::npos ||
        folder.front() == '/' || folder.back() == '/') {
      fail(signal.line, place + ": its ClassFolder '" + folder +
                            "' is no folder of small letters, digits, _ and / below the project");
    }
    for (const ValueName& value : signal.values) {
      if (is_reserved(value.name)) {
        fail(value.line, place + ": '" + value.name + "' is a word of C++, so it can be no class");
      }
    }
  }

  void check_flags(const DbcMessage& message) const {
    for (const DbcSignal& signal : message.signals) {
      if (signal.flags().empty()) continue;
      const std::string place = message.name + "." + signal.name;
      if (signal.length != 1 || signal.is_signed) {
        fail(signal.line, place + ": a flag has one bit, unsigned");
      }
      if (!plain_name(signal.flags(), false)) {
        fail(signal.line, place + ": its attribute Flags is no name of small letters");
      }
    }
    for (const Field& field : fields_of(message)) {
      const DbcSignal& first = *field.signals.front();
      if (first.flags().empty()) continue;
      const std::string place = message.name + "." + field.name;
      if (field.start % 8 != 0) fail(first.line, place + ": flags begin with a byte");
      if (field.start + field.length > 8 * message.size) {
        fail(first.line, place + ": flags fill whole bytes, which the message does not have");
      }
      for (const DbcSignal& signal : message.signals) {
        const bool inside =
            signal.start + signal.length > field.start && signal.start < field.start + field.length;
        if ((inside && signal.flags() != field.name) || signal.name == field.name) {
          fail(signal.line, message.name + "." + signal.name + ": is in the way of the flags " +
                                field.name + ", which fill " + std::to_string(field.length / 8) +
                                " bytes");
        }
      }
    }
  }

  const Database& database_;
};

}  // namespace

bool is_protection(const DbcMessage& message, const DbcSignal& signal) {
  return message.protected_by_crc() && signal.start < 16 &&
         (signal.name == "crc" || signal.name == "counter");
}

std::vector<Field> fields_of(const DbcMessage& message) {
  std::vector<Field> fields;
  std::vector<const DbcSignal*> signals;
  for (const DbcSignal& signal : message.signals) signals.push_back(&signal);
  std::stable_sort(signals.begin(), signals.end(),
                   [](const DbcSignal* a, const DbcSignal* b) { return a->start < b->start; });
  for (const DbcSignal* signal : signals) {
    if (is_protection(message, *signal)) continue;
    const std::string flags = signal->flags();
    const auto found = std::find_if(fields.begin(), fields.end(), [&](const Field& it) {
      return !flags.empty() && it.name == flags;
    });
    if (found == fields.end()) {
      fields.push_back({flags.empty() ? signal->name : flags,
                        signal->start,
                        signal->length,
                        signal->is_signed,
                        {signal}});
    } else {
      found->signals.push_back(signal);
      found->length = signal->start + 1 - found->start;
    }
  }
  for (Field& field : fields) {
    if (field.signals.front()->flags().empty()) continue;
    field.length = field.length <= 8 ? 8 : field.length <= 16 ? 16 : 32;
  }
  return fields;
}

void check_schema(const Database& database) {
  Checker(database).check();
}

}  // namespace screed::schema
