// Parameters of the firmware as people name and write them: by name, in a unit that is no multiple
// of one, with names for values that have them.
//
// The table (firmware/parameters/parameters.h) holds whole numbers of its units, such as 500 of
// "0.01 deg". People read and write 5 deg.
//
// A file of parameters is an experiment: its [parameters], and the algorithm of its [experiment].
// So the dump of a robot drives in the simulation, and an experiment can be loaded into a robot.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "firmware/parameters/parameters.h"

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

/// A parameter's place in the table, and its value there.
struct ParameterValue {
  uint16_t index;
  int16_t value;

  bool operator==(const ParameterValue&) const = default;
};

/// All of them, in the order of the table; and back.
std::vector<ParameterValue> all_parameters(const Parameters& parameters);
void set_parameter(Parameters& parameters, const ParameterValue& value);
int16_t get_parameter(const Parameters& parameters, uint16_t index);

/// The parameters that an experiment file names, in the order of the table. The whole file is
/// checked as `screed sim` does. Throws InputError with file and line, and when it names none.
std::vector<ParameterValue> read_parameter_file(const std::filesystem::path& file);

/// A file that read_parameter_file() reads as these parameters, with the units that people read in
/// comments, and `title` in the first line.
std::string parameter_file_text(const Parameters& parameters, const std::string& title);

/// The order in which these values can be written, one by one, so that a robot with the parameters
/// `now` takes each: it refuses values that do not fit the others (walk_speed_min above
/// walk_speed_max). Values that it has already are left out. Throws InputError when the whole does
/// not fit together.
std::vector<ParameterValue> writing_order(Parameters now,
                                          const std::vector<ParameterValue>& wanted);

}  // namespace screed
