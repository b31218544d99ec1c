// The messages as C++14 for the microcontroller and the host: a structure each, with pack() and
// unpack(). The code holds no tables, no loops and no text.
#pragma once

#include <string>

#include "tools/schema/dbc.h"

namespace screed::schema {

/// The header schema/messages.h of a checked database.
std::string message_code(const Database& database);

}  // namespace screed::schema
