// Names and numbers as the generated code writes them.
#pragma once

#include <string>

#include "tools/schema/dbc.h"
#include "tools/schema/schema_check.h"

namespace screed::schema {

/// COMMAND_ACK or command_ack -> CommandAck.
std::string pascal_case(const std::string& name);

/// command_ack -> COMMAND_ACK, and back.
std::string capitals(std::string name);
std::string small_letters(std::string name);

/// 529 -> "0x211".
std::string id_text(std::uint32_t id);

/// The unsigned type that holds so many bits: "uint8_t", ...; bits 1..32.
std::string unsigned_type(int bits);

/// The first line of every generated file, after the comment sign.
std::string made_from(const Database& database);

// The messages as tables for the host (host_sim/ground_station/telemetry/schema.h).

/// The header schema/tables.h of a checked database.
std::string host_tables(const Database& database);

// Names of values and flags as C++14 enumerations.

/// The header schema/values.h of a checked schema: an enumeration for every signal with names of
/// values (VAL_), one for every field of flags. It includes nothing of the project, so that every
/// layer may use it.
std::string value_code(const Database& database);

/// The header schema/class_values.h: the enumerations of signals whose values name classes
/// (attribute "ClassFolder"), which schema/values.h only declares, and a list of each.
std::string class_values(const Database& database);

/// The header schema/classes.h: for every signal with the attribute "ClassFolder" the headers of
/// its values' classes, FOLDER/<name>.h.
std::string class_includes(const Database& database);

// The messages as C++14 for the microcontroller and the host: a structure each, with pack() and
// unpack(). The code holds no tables, no loops and no text.

/// The header schema/messages.h of a checked database.
std::string message_code(const Database& database);

}  // namespace screed::schema
