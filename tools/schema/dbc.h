// A CAN database (DBC) as it stands in its file, every part with the line it stands on. Knows the
// language, not which of it this project allows (schema_check.h).
//
// Source: Vector Informatik, "DBC File Format Documentation", 1.0.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace screed::schema {

/// A decimal number as written, exact: mantissa / 10^decimals.
struct Decimal {
  std::int64_t mantissa = 0;
  int decimals = 0;  ///< 0..18

  [[nodiscard]] double value() const;
  /// Shortest decimal text, as "0.01" or "-3".
  [[nodiscard]] std::string text() const;
};

struct ValueName {
  std::int64_t value = 0;
  std::string name;
  int line = 0;
};

struct DbcSignal {
  std::string name;
  int line = 0;
  std::string multiplexer;  ///< "M", "m0", ...; empty: none
  int start = 0;            ///< bit, as written
  int length = 0;           ///< bits
  bool little_endian = true;
  bool is_signed = false;
  bool is_float = false;  ///< by SIG_VALTYPE_
  Decimal scale;
  Decimal offset;
  Decimal minimum;
  Decimal maximum;
  std::string unit;
  std::string comment;
  std::vector<ValueName> values;  ///< of VAL_
  int values_line = 0;
  std::map<std::string, std::string> attributes;  ///< BA_; enumerations by name

  /// The attribute "Flags": the field of the message that this bit belongs to; empty: none.
  [[nodiscard]] std::string flags() const;
  /// The attribute "ClassFolder": every value is a class of its name, pascal case, in
  /// FOLDER/<name>.h; empty: none.
  [[nodiscard]] std::string class_folder() const;
};

struct DbcMessage {
  std::uint32_t id = 0;  ///< as written: bit 31 set is an extended id
  std::string name;
  int line = 0;
  int size = 0;  ///< bytes
  std::string sender;
  std::string comment;
  std::vector<DbcSignal> signals;
  std::map<std::string, std::string> attributes;

  [[nodiscard]] bool from_ground() const;       ///< its sender is the node GROUND
  [[nodiscard]] bool protected_by_crc() const;  ///< attribute "Protection" is "e2e"
  [[nodiscard]] int period_ms() const;          ///< attribute "GenMsgCycleTime"; 0: no period
};

struct Database {
  std::string file;
  std::string comment;
  std::vector<std::string> nodes;
  std::vector<DbcMessage> messages;
};

/// Parses a DBC file. Throws InputError "FILE:LINE: what" at the first thing that is not DBC, or
/// that refers to what is not there.
Database parse_dbc(const std::string& file, const std::string& text);

/// Reads and parses a file; InputError as well when it cannot be read.
Database read_dbc(const std::string& file);

}  // namespace screed::schema
