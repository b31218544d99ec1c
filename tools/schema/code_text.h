// Names and numbers as the generated code writes them.
#pragma once

#include <string>

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

}  // namespace screed::schema
