// The messages as tables for people, in Markdown.
#pragma once

#include <map>
#include <string>

#include "tools/schema/dbc.h"

namespace screed::schema {

/// A page with the part between its two marks renewed. Throws InputError when a mark is missing.
std::string renewed_page(const std::string& file, const std::string& page,
                         const Database& database);

// The messages as a configuration profile of Wireshark and tshark: tables of its Signal PDU
// dissector, which decodes CAN frames by them.
//
// Source: Wireshark 4.0, epan/dissectors/packet-signal-pdu.c and its descriptions of the tables.

/// The files of the profile of a checked database: name and text. The ids of all 15 robots lead to
/// the messages.
std::map<std::string, std::string> wireshark_tables(const Database& database);

}  // namespace screed::schema
