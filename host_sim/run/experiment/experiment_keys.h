// The keys of experiment files: one table for reading, writing back and the documentation, made
// from the sections (ground_sections.h, vehicle_sections.h).
#pragma once

#include <charconv>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "host_sim/run/experiment/experiment.h"

namespace screed {

inline constexpr const char* kUnitsKey = "units";
inline constexpr const char* kSandboxKey = "chrono_data_path";
inline constexpr double kSandboxUnitsPerMetre = 12.0;

/// One key of an experiment file: how its value is read, written back and described.
struct ExperimentKey {
  std::string section;
  std::string name;
  std::string unit;
  std::string allowed;  ///< for people
  std::string meaning;
  /// Returns false when the value is not allowed.
  std::function<bool(Experiment&, const std::string&)> set;
  /// The value in force; nothing when an optional key is not set.
  std::function<std::optional<std::string>(const Experiment&)> get;
  /// Its default is written as well. Not of a key that decides nothing: texts, and with them the
  /// content hashes of their runs, are what they were without it.
  bool default_written = true;
  /// Values are integers, and multiples of this; 0: they are none.
  uint64_t multiple_of = 0;
};

/// By section, in the order in which they are written.
const std::vector<ExperimentKey>& experiment_keys();
/// The key of this name. Throws InputError that begins with `where` and lists what is known.
const ExperimentKey& find_experiment_key(const std::string& section, const std::string& name,
                                         const std::string& where);

/// Whether all of the text is a number.
template <class Number>
bool parse_number(const std::string& text, Number& value) {
  const char* const end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  return result.ec == std::errc() && result.ptr == end && !text.empty();
}

}  // namespace screed
