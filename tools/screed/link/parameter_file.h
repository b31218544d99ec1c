// Parameters in files. A file of parameters is an experiment: its [parameters], and the algorithm
// of its [experiment]. So the dump of a robot drives in the simulation, and an experiment can be
// loaded into a robot.
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
