// What of DBC this project allows: what independent decoders read alike, and what the generated
// code can say.
#pragma once

#include "tools/schema/dbc.h"

namespace screed::schema {

/// Throws InputError "FILE:LINE: what, what is allowed" at the first line that breaks a rule
/// (docs/telemetry.md lists them).
void check_schema(const Database& database);

/// A field of a message: what the generated structures hold. One signal, or the one-bit signals
/// that share a value of the attribute "Flags", as one number of whole bytes.
struct Field {
  std::string name;
  int start = 0;
  int length = 0;
  bool is_signed = false;
  std::vector<const DbcSignal*> signals;  ///< several: flags, lowest bit first
};

/// The fields of a checked message, by their place; without CRC and counter of its protection.
std::vector<Field> fields_of(const DbcMessage& message);

/// CRC or alive counter of a protected message.
bool is_protection(const DbcMessage& message, const DbcSignal& signal);

}  // namespace screed::schema
