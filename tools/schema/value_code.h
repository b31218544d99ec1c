// Names of values and flags as C++14 enumerations.
#pragma once

#include <string>

#include "tools/schema/dbc.h"

namespace screed::schema {

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

}  // namespace screed::schema
