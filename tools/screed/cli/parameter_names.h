// Parameters of the firmware as people name and write them: by name, in a unit that is no multiple
// of one, with names for values that have them.
//
// The table (firmware/parameters/parameters.h) holds whole numbers of its units, such as 500 of
// "0.01 deg". People read and write 5 deg.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace screed {

/// In the order of the table.
std::vector<std::string> parameter_names();

/// A parameter's place in the table. Throws InputError that names the nearest and where to find
/// all.
uint16_t parameter_index(const std::string& name);

/// The unit that people read: "deg" for the table's "0.01 deg"; empty: none.
std::string parameter_unit(uint16_t index);

/// A value of the table, as people read it: "5 deg", "hill_sensing".
std::string parameter_text(uint16_t index, int32_t value);

/// What is allowed: "1 to 45 deg", "hill_sensing, spin_on_peak or drive".
std::string parameter_range(uint16_t index);

/// The table's value of what a person writes: a name, or a number with or without its unit, rounded
/// to the nearest step of a scaled one. A unit of a thousand of it is understood as well: 6 V for
/// 6000 mV. Throws InputError that says what is allowed.
int16_t parameter_value(uint16_t index, const std::string& text);

/// Throws InputError, as parameter_value(), for a value of the table that is out of range.
int16_t checked_parameter(uint16_t index, int32_t value);

}  // namespace screed
