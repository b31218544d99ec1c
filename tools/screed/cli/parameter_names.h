// Parameters of the firmware by their names, for subcommands.
#pragma once

#include <cstdint>
#include <string>

namespace screed {

/// A parameter's place in the table. Throws InputError that lists the names.
uint16_t parameter_index(const std::string& name);

/// A value of it, as written by a person. Throws InputError that says what is allowed.
int16_t parameter_value(uint16_t index, const std::string& text);

}  // namespace screed
