// The messages as tables for people, in Markdown.
#pragma once

#include <string>

#include "tools/schema/dbc.h"

namespace screed::schema {

/// A page with the part between its two marks renewed. Throws InputError when a mark is missing.
std::string renewed_page(const std::string& file, const std::string& page,
                         const Database& database);

}  // namespace screed::schema
