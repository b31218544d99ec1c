// The messages as tables for the host (host_sim/ground_station/telemetry/schema.h).
#pragma once

#include <string>

#include "tools/schema/dbc.h"

namespace screed::schema {

/// The header schema/tables.h of a checked database.
std::string host_tables(const Database& database);

}  // namespace screed::schema
