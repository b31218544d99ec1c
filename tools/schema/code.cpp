// Names and numbers as the generated code writes them.
#include "tools/schema/code.h"

#include <algorithm>
#include <cctype>
#include <cstdio>

#include "tools/schema/schema_check.h"

namespace screed::schema {

std::string pascal_case(const std::string& name) {
  std::string out;
  bool first = true;
  for (const char c : name) {
    if (c == '_') {
      first = true;
      continue;
    }
    const auto byte = static_cast<unsigned char>(c);
    out += static_cast<char>(first ? std::toupper(byte) : std::tolower(byte));
    first = false;
  }
  return out;
}

std::string capitals(std::string name) {
  for (char& c : name) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return name;
}

std::string small_letters(std::string name) {
  for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return name;
}

std::string id_text(std::uint32_t id) {
  char text[16];
  std::snprintf(text, sizeof text, "0x%03X", static_cast<unsigned>(id));
  return text;
}

std::string unsigned_type(int bits) {
  return bits <= 8 ? "uint8_t" : bits <= 16 ? "uint16_t" : "uint32_t";
}

std::string made_from(const Database& database) {
  return "Made from " + database.file + " by tools/schema: change that file, not this one.";
}

// The messages as tables for the host.

namespace {

std::string quoted(const std::string& text) {
  return "\"" + text + "\"";
}

std::string values_name(const DbcMessage& message, const DbcSignal& signal) {
  return "k" + pascal_case(message.name) + pascal_case(signal.name) + "Values";
}

std::string number_at(Decimal number, int decimals) {
  for (; number.decimals < decimals; ++number.decimals) number.mantissa *= 10;
  return std::to_string(number.mantissa);
}

std::string role(const DbcMessage& message, const DbcSignal& signal) {
  if (!is_protection(message, signal)) return "SignalRole::kData";
  return signal.name == "crc" ? "SignalRole::kCrc" : "SignalRole::kCounter";
}

std::string signal_row(const DbcMessage& message, const DbcSignal& signal) {
  const int decimals = std::max(signal.scale.decimals, signal.offset.decimals);
  return "    {" + quoted(signal.name) + ", " + quoted(signal.unit) + ", " +
         quoted(signal.flags()) + ", " + quoted(signal.comment) + ", " + role(message, signal) +
         ", " + std::to_string(signal.start) + ", " + std::to_string(signal.length) + ", " +
         (signal.is_signed ? "true" : "false") + ", " + std::to_string(decimals) + ", " +
         number_at(signal.scale, decimals) + ", " + number_at(signal.offset, decimals) + ", " +
         (signal.values.empty() ? "{}" : values_name(message, signal)) + "},\n";
}

}  // namespace

std::string host_tables(const Database& database) {
  std::string text = "// " + made_from(database) +
                     "\n#pragma once\n\n#include \"host_sim/ground_station/telemetry/schema.h\"\n\n"
                     "namespace screed::schema_tables {\n\n";
  for (const DbcMessage& message : database.messages) {
    for (const DbcSignal& signal : message.signals) {
      if (signal.values.empty()) continue;
      text += "constexpr ValueInfo " + values_name(message, signal) + "[] = {";
      for (const ValueName& value : signal.values) {
        text += "{" + std::to_string(value.value) + ", " + quoted(value.name) + "}, ";
      }
      text.resize(text.size() - 2);
      text += "};\n";
    }
    text += "constexpr SignalInfo k" + pascal_case(message.name) + "Signals[] = {\n";
    for (const DbcSignal& signal : message.signals) text += signal_row(message, signal);
    text += "};\n";
  }
  text += "\nconstexpr MessageInfo kMessages[] = {\n";
  for (const DbcMessage& message : database.messages) {
    text += "    {" + quoted(message.name) + ", " + quoted(small_letters(message.name)) + ", " +
            quoted(message.comment) + ", " + id_text(message.id) + ", " +
            std::to_string(message.size) + ", " + std::to_string(message.period_ms()) + ", " +
            (message.from_ground() ? "true" : "false") + ", " +
            (message.protected_by_crc() ? "true" : "false") + ", k" + pascal_case(message.name) +
            "Signals},\n";
  }
  return text + "};\n\n}  // namespace screed::schema_tables\n";
}

// Names of values and flags as C++14 enumerations.

namespace {

std::string type_name(const DbcMessage& message, const Field& field) {
  return pascal_case(message.name) + pascal_case(field.name);
}

std::string comment_of(const DbcMessage& message, const Field& field, const std::string& comment) {
  return "/// " + message.name + "." + field.name + (comment.empty() ? "" : ": " + comment) + "\n";
}

/// X(number, name, Name) for every value: a table of the classes that they name.
std::string list_macro(const DbcMessage& message, const Field& field) {
  std::string text = "#define SCREED_" + message.name + "_" + capitals(field.name) + "(X)";
  for (const ValueName& value : field.signals.front()->values) {
    text += " \\\n  X(" + std::to_string(value.value) + ", " + value.name + ", " +
            pascal_case(value.name) + ")";
  }
  return text + "\n\n";
}

std::string enumeration(const DbcMessage& message, const Field& field) {
  return "enum class " + type_name(message, field) + " : " + unsigned_type(field.length);
}

std::string value_names(const DbcMessage& message, const Field& field) {
  const DbcSignal& signal = *field.signals.front();
  const std::string type = unsigned_type(field.length);
  const std::string name = type_name(message, field);
  std::string text =
      comment_of(message, field, signal.comment) + enumeration(message, field) + " {\n";
  std::int64_t max = 0;
  for (const ValueName& value : signal.values) {
    text += "  k" + pascal_case(value.name) + " = " + std::to_string(value.value) + ",\n";
    max = std::max(max, value.value);
  }
  text += "};\nconstexpr " + type + " k" + name + "Max = " + std::to_string(max) +
          ";  ///< the greatest of them\n";
  return text + "\n";
}

std::string flags(const DbcMessage& message, const Field& field) {
  std::string text = comment_of(message, field, "a bit each") + "struct " +
                     type_name(message, field) + " {\n  enum : " + unsigned_type(field.length) +
                     " {\n";
  for (const DbcSignal* flag : field.signals) {
    text += "    k" + pascal_case(flag->name) + " = 1U << " +
            std::to_string(flag->start - field.start) + ",";
    if (!flag->comment.empty()) text += "  ///< " + flag->comment;
    text += "\n";
  }
  return text + "  };\n};\n\n";
}

constexpr const char* kHead =
    "#pragma once\n\n#include <stdint.h>\n\nnamespace screed {\nnamespace message {\n\n";
constexpr const char* kTail = "}  // namespace message\n}  // namespace screed\n";

}  // namespace

std::string value_code(const Database& database) {
  std::string text = "// " + made_from(database) +
                     "\n//\n"
                     "// Of every signal with names of values an enumeration and its greatest "
                     "value, of every field\n"
                     "// of flags their bits. Values that name classes stand in class_values.h: "
                     "what does not name\n"
                     "// one of them need not be compiled anew when one is added.\n" +
                     kHead;
  for (const DbcMessage& message : database.messages) {
    for (const Field& field : fields_of(message)) {
      const DbcSignal& first = *field.signals.front();
      if (!first.flags().empty()) {
        text += flags(message, field);
      } else if (!first.class_folder().empty()) {
        text += enumeration(message, field) + ";\n\n";
      } else if (!first.values.empty()) {
        text += value_names(message, field);
      }
    }
  }
  return text + kTail;
}

std::string class_values(const Database& database) {
  std::string text = "// " + made_from(database) +
                     "\n//\n"
                     "// Of every signal whose values name classes an enumeration, its greatest "
                     "value, and a list\n"
                     "// X(number, name, Name).\n" +
                     kHead;
  for (const DbcMessage& message : database.messages) {
    for (const Field& field : fields_of(message)) {
      if (field.signals.front()->class_folder().empty()) continue;
      text += value_names(message, field) + list_macro(message, field);
    }
  }
  return text + kTail;
}

std::string class_includes(const Database& database) {
  std::string text = "// " + made_from(database) + "\n#pragma once\n";
  for (const DbcMessage& message : database.messages) {
    for (const DbcSignal& signal : message.signals) {
      if (signal.class_folder().empty()) continue;
      text += "\n// The classes of " + message.name + "." + signal.name + ".\n";
      for (const ValueName& value : signal.values) {
        text += "#include \"" + signal.class_folder() + "/" + value.name + ".h\"\n";
      }
    }
  }
  return text;
}

// The messages as C++14.

namespace {

std::string type_of(const Field& field) {
  const std::string type = unsigned_type(field.length);
  return field.is_signed ? type.substr(1) : type;
}

/// Whole bytes in one of the sizes that firmware/protocol/bytes.h reads and writes.
bool in_whole_bytes(const Field& field) {
  return field.start % 8 == 0 && (field.length == 16 || field.length == 32);
}

std::string number_of(const Field& field) {
  return (field.is_signed ? "s" : "u") + std::to_string(field.length);
}

std::string hex_mask(int bits) {
  constexpr char kDigits[] = "0123456789ABCDEF";
  const unsigned mask = (1U << static_cast<unsigned>(bits)) - 1U;
  return std::string("0x") + kDigits[mask >> 4U] + kDigits[mask & 0xFU] + "U";
}

/// The part of a field that stands in one byte.
struct Piece {
  int byte;
  int low;    ///< lowest bit in the byte
  int bits;   ///< how many
  int shift;  ///< lowest bit in the field
};

std::vector<Piece> pieces_of(const Field& field) {
  std::vector<Piece> pieces;
  for (int done = 0; done < field.length;) {
    const int bit = field.start + done;
    const int bits = std::min(8 - bit % 8, field.length - done);
    pieces.push_back({bit / 8, bit % 8, bits, done});
    done += bits;
  }
  return pieces;
}

std::string bracketed(const std::string& text, const std::string& operation) {
  return "(" + text + operation + ")";
}

std::string cast_to(const std::string& type, const std::string& text) {
  return "static_cast<" + type + ">(" + text + ")";
}

/// The value of one byte's piece, as an expression of unsigned int.
std::string put_expression(const Field& field, const Piece& piece) {
  std::string text = field.name;
  if (field.is_signed) text = cast_to(unsigned_type(field.length), text);
  if (piece.shift > 0) text = bracketed(text, " >> " + std::to_string(piece.shift));
  if (piece.bits < 8 || field.length > 8) text = bracketed(text, " & " + hex_mask(piece.bits));
  if (piece.low > 0) text = bracketed(text, " << " + std::to_string(piece.low));
  return text;
}

std::string get_expression(const Field& field) {
  if (in_whole_bytes(field)) {
    return "get_" + number_of(field) + "(data + " + std::to_string(field.start / 8) + ")";
  }
  std::string sum;
  for (const Piece& piece : pieces_of(field)) {
    std::string text = "data[" + std::to_string(piece.byte) + "]";
    if (piece.low > 0) text = bracketed(text, " >> " + std::to_string(piece.low));
    if (piece.low + piece.bits < 8) text = bracketed(text, " & " + hex_mask(piece.bits));
    if (piece.shift > 0) {
      const std::string type = unsigned_type(field.length);
      text = cast_to(type, cast_to(type, text) + " << " + std::to_string(piece.shift));
    }
    sum += (sum.empty() ? "" : " | ") + text;
  }
  return cast_to(type_of(field), sum);
}

std::string meaning(const Field& field) {
  if (!field.signals.front()->flags().empty()) {
    std::string names = "flags:";
    for (const DbcSignal* signal : field.signals) names += " " + signal->name;
    return names;
  }
  const DbcSignal& signal = *field.signals.front();
  std::string text = signal.comment;
  if (!signal.values.empty()) {
    std::string names;
    for (const ValueName& value : signal.values) {
      names += (names.empty() ? "" : ", ") + std::to_string(value.value) + " " + value.name;
    }
    text += (text.empty() ? "" : "; ") + names;
  }
  if (signal.unit.empty()) return text;
  std::string unit = signal.scale.text() + " " + signal.unit;
  if (signal.offset.mantissa != 0) unit += ", from " + signal.offset.text();
  return text.empty() ? unit : unit + ": " + text;
}

/// Bytes that a message's fields do not reach are 0; the CRC's is left alone.
std::string pack_body(const DbcMessage& message) {
  std::vector<std::string> bytes(static_cast<size_t>(message.size));
  std::string whole;
  std::vector<bool> written(bytes.size(), false);
  for (const Field& field : fields_of(message)) {
    if (in_whole_bytes(field)) {
      whole += "    put_" + number_of(field) + "(data + " + std::to_string(field.start / 8) + ", " +
               field.name + ");\n";
      const auto first = written.begin() + field.start / 8;
      std::fill(first, first + field.length / 8, true);
      continue;
    }
    for (const Piece& piece : pieces_of(field)) {
      std::string& byte = bytes[static_cast<size_t>(piece.byte)];
      byte += (byte.empty() ? "" : " | ") + put_expression(field, piece);
    }
  }
  std::string text;
  for (size_t i = message.protected_by_crc() ? 1 : 0; i < bytes.size(); ++i) {
    if (written[i]) continue;
    text += "    data[" + std::to_string(i) + "] = ";
    text += bytes[i].empty() ? "0" : "static_cast<uint8_t>(" + bytes[i] + ")";
    text += ";\n";
  }
  return text + whole;
}

std::string structure(const DbcMessage& message) {
  const std::string name = pascal_case(message.name);
  std::string text = "/// " + message.comment + "\n";
  text += "struct " + name + " {\n";
  text += "  enum : uint16_t { kId = " + id_text(message.id) + " };\n";
  text += "  enum : uint8_t { kSize = " + std::to_string(message.size) + " };\n";
  if (message.period_ms() != 0) {
    text += "  enum : uint16_t { kPeriod_ms = " + std::to_string(message.period_ms()) + " };\n";
  }
  text += "\n";
  const std::vector<Field> fields = fields_of(message);
  for (const Field& field : fields) {
    text += "  " + type_of(field) + " " + field.name + ";  ///< " + meaning(field) + "\n";
  }
  text += "\n  void pack(uint8_t* data) const {\n" + pack_body(message) + "  }\n";
  text += "  static " + name + " unpack(const uint8_t* data) {\n    " + name + " message{};\n";
  for (const Field& field : fields) {
    text += "    message." + field.name + " = " + get_expression(field) + ";\n";
  }
  return text + "    return message;\n  }\n};\n\n";
}

std::ptrdiff_t periodic_messages(const Database& database) {
  return std::count_if(
      database.messages.begin(), database.messages.end(),
      [](const DbcMessage& it) { return it.period_ms() != 0 && !it.from_ground(); });
}

}  // namespace

std::string message_code(const Database& database) {
  std::string text = "// " + made_from(database) + "\n//\n";
  text +=
      "// pack() fills kSize bytes. Of a protected message it leaves byte 0, the CRC, alone and\n"
      "// writes 0 into the counter: e2e_protect() fills both. Fields are raw; their comments say\n"
      "// what one step is.\n"
      "#pragma once\n\n#include <stdint.h>\n\n#include \"firmware/protocol/bytes.h\"\n"
      "#include \"schema/values.h\"\n\n"
      "namespace screed {\n\nenum MessageId : uint16_t {\n";
  for (const DbcMessage& message : database.messages) {
    text += "  kId" + pascal_case(message.name) + " = " + id_text(message.id) + ",\n";
  }
  text +=
      "};\n\n/// Messages that the robot sends by their periods.\nconstexpr uint8_t "
      "kPeriodicMessages = " +
      std::to_string(periodic_messages(database)) + ";\n\nnamespace message {\n\n";
  for (const DbcMessage& message : database.messages) {
    text += structure(message);
  }
  return text + "}  // namespace message\n\n}  // namespace screed\n";
}

}  // namespace screed::schema
