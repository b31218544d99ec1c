// The messages as C++14.
#include "tools/schema/message_code.h"

#include <algorithm>

#include "tools/schema/code_text.h"
#include "tools/schema/schema_check.h"

namespace screed::schema {
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
