// Parameters of the firmware as people name and write them, and in files.
#include "tools/screed/link/named_parameters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <set>
#include <span>

#include "firmware/parameters/parameters.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/ini_file.h"
#include "host_sim/core/name_list.h"
#include "host_sim/ground_station/telemetry/schema.h"
#include "host_sim/run/experiment/experiment.h"
#include "tools/command_line/program.h"
#include "tools/screed/cli/number_option.h"

namespace screed {
namespace {

/// A unit of the table, "0.01 deg" or "1/256 per s" or "mm/s", as a number and the unit without it.
struct Unit {
  double scale = 1.0;
  std::string name;

  bool is_scaled() const { return scale != 1.0; }
};

Unit unit_of(const ParameterInfo& info) {
  const std::string text = info.unit;
  const std::size_t blank = text.find(' ');
  const std::string first = text.substr(0, blank);
  const std::size_t slash = first.find('/');
  const std::optional<double> number = finite_number<double>(first.substr(0, slash));
  if (!number.has_value()) return {1.0, text};
  const std::optional<double> below =
      slash == std::string::npos ? 1.0 : finite_number<double>(first.substr(slash + 1));
  return {*number / below.value_or(1.0), blank == std::string::npos ? "" : text.substr(blank + 1)};
}

/// Names of the values: of the leveling algorithm alone. Empty: a number.
std::span<const ValueInfo> value_names_of(const ParameterInfo& info) {
  if (info.number != Parameters::k_algorithm) return {};
  return find_signal("leveling.algorithm").signal->values;
}

std::string scaled_text(double value) {
  constexpr int kDigits = 10;  // hides what 0.07 * 3 has behind 0.21
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.*g", kDigits, value);
  return text.data();
}

[[noreturn]] void refuse(uint16_t index, const std::string& text) {
  throw InputError(std::string(kParameterTable[index].name) + " = '" + text +
                   "' is not allowed; allowed are " + parameter_range(index));
}

/// The unit of a thousand of this one: "V" of "mV", "m/s" of "mm/s"; empty: none.
std::string thousand_of(const std::string& unit) {
  return unit.size() > 1 && unit[0] == 'm' ? unit.substr(1) : "";
}

/// "5 deg", "5deg", "5" in the unit without its scale.
std::optional<double> number_in(const Unit& unit, const std::string& text) {
  const std::size_t end = text.find_first_not_of("+-.0123456789");
  const std::optional<double> number = finite_number<double>(text.substr(0, end));
  if (!number.has_value() || end == std::string::npos) return number;
  const std::size_t begin = text.find_first_not_of(' ', end);
  const std::string said = begin == std::string::npos ? "" : text.substr(begin);
  if (said.empty()) return std::nullopt;
  if (said == unit.name) return number;
  if (said == thousand_of(unit.name)) return *number * 1000.0;
  return std::nullopt;
}

}  // namespace

std::vector<std::string> parameter_names() {
  std::vector<std::string> names;
  for (const ParameterInfo& info : kParameterTable) names.emplace_back(info.name);
  return names;
}

uint16_t parameter_index(const std::string& name) {
  uint16_t index = 0;
  for (const ParameterInfo& info : kParameterTable) {
    if (name == info.name) return index;
    ++index;
  }
  const std::string nearest = nearest_word(name, parameter_names());
  throw InputError("unknown parameter '" + name + "'; " +
                   (nearest.empty() ? "" : "did you mean " + nearest + "? ") +
                   "screed param list shows all");
}

std::string parameter_unit(uint16_t index) {
  return unit_of(kParameterTable[index]).name;
}

std::string parameter_text(uint16_t index, int32_t value) {
  const ParameterInfo& info = kParameterTable[index];
  for (const ValueInfo& named : value_names_of(info)) {
    if (static_cast<int32_t>(named.value) == value) return named.name;
  }
  const Unit unit = unit_of(info);
  const std::string number =
      unit.is_scaled() ? scaled_text(value * unit.scale) : std::to_string(value);
  return unit.name.empty() ? number : number + " " + unit.name;
}

std::string parameter_range(uint16_t index) {
  const ParameterInfo& info = kParameterTable[index];
  if (!value_names_of(info).empty()) {
    std::vector<std::string> names;
    for (const ValueInfo& named : value_names_of(info)) {
      const auto value = static_cast<int32_t>(named.value);
      if (value >= info.min && value <= info.max) names.emplace_back(named.name);
    }
    return name_list(names, " or ");
  }
  const Unit unit = unit_of(info);
  const std::string low = unit.is_scaled() ? scaled_text(info.min * unit.scale)
                                           : "whole numbers " + std::to_string(info.min);
  return low + " to " + parameter_text(index, info.max);
}

int16_t parameter_value(uint16_t index, const std::string& text) {
  const ParameterInfo& info = kParameterTable[index];
  for (const ValueInfo& named : value_names_of(info)) {
    if (text == named.name) return checked_parameter(index, static_cast<int32_t>(named.value));
  }
  const Unit unit = unit_of(info);
  const std::optional<double> number = number_in(unit, text);
  if (!number.has_value()) refuse(index, text);
  const double steps = *number / unit.scale;
  const double value = std::round(steps);
  const bool is_step = unit.is_scaled() || std::abs(steps - value) < 1e-9;
  if (!is_step || value < info.min || value > info.max) refuse(index, text);
  return static_cast<int16_t>(value);
}

int16_t checked_parameter(uint16_t index, int32_t value) {
  const ParameterInfo& info = kParameterTable[index];
  if (value < info.min || value > info.max) refuse(index, parameter_text(index, value));
  return static_cast<int16_t>(value);
}

// ---- in files ----

namespace {

constexpr uint16_t kTableSize = sizeof(kParameterTable) / sizeof(kParameterTable[0]);

/// The names of parameters that the file has a value for.
std::set<std::string> named_in(const std::vector<IniEntry>& entries) {
  std::set<std::string> names;
  for (const IniEntry& entry : entries) {
    if (entry.section == "parameters") names.insert(entry.key);
    if (entry.section != "experiment" || entry.key != "algorithm") continue;
    names.insert("algorithm");
    // Its length comes with it.
    if (entry.value == kTrainingDriveName) names.insert("training_block");
  }
  return names;
}

}  // namespace

std::vector<ParameterValue> all_parameters(const Parameters& parameters) {
  std::vector<ParameterValue> all;
  all.reserve(kTableSize);
  for (uint16_t i = 0; i < kTableSize; ++i) all.push_back({i, get_parameter(parameters, i)});
  return all;
}

void set_parameter(Parameters& parameters, const ParameterValue& value) {
  parameters.values[value.index] = value.value;
}

int16_t get_parameter(const Parameters& parameters, uint16_t index) {
  return parameters.values[index];
}

std::vector<ParameterValue> read_parameter_file(const std::filesystem::path& file) {
  const std::filesystem::path path = find_experiment(file);
  const std::set<std::string> named = named_in(read_ini_file(path));
  const Experiment experiment = read_experiment(path);
  std::vector<ParameterValue> values;
  for (const ParameterValue& value : all_parameters(experiment.parameters)) {
    if (named.contains(kParameterTable[value.index].name)) values.push_back(value);
  }
  if (values.empty()) {
    throw InputError(path.string() +
                     ": names no parameter: neither [parameters] nor [experiment] algorithm");
  }
  return values;
}

std::string parameter_file_text(const Parameters& parameters, const std::string& title) {
  constexpr int kFramesPerBlock = 8;  // of Algorithm 5
  const uint16_t algorithm = parameter_index("algorithm");
  const std::string name = parameter_text(algorithm, parameters.algorithm());
  std::string text = "# " + title + "\n[experiment]\nalgorithm = " + name + "\n";
  if (name == kTrainingDriveName)
    text += "frames = " + std::to_string(parameters.training_block() * kFramesPerBlock) + "\n";
  text += "\n[parameters]\n";
  for (const ParameterValue& value : all_parameters(parameters)) {
    if (value.index == algorithm) continue;
    text += kParameterTable[value.index].name;
    text += " = " + std::to_string(value.value);
    if (!parameter_unit(value.index).empty())
      text += "  # " + parameter_text(value.index, value.value);
    text += "\n";
  }
  return text;
}

std::vector<ParameterValue> writing_order(Parameters now,
                                          const std::vector<ParameterValue>& wanted) {
  std::vector<ParameterValue> left;
  std::copy_if(wanted.begin(), wanted.end(), std::back_inserter(left),
               [&](const ParameterValue& v) { return get_parameter(now, v.index) != v.value; });
  std::vector<ParameterValue> order;
  order.reserve(left.size());
  while (!left.empty()) {
    const auto next = std::find_if(left.begin(), left.end(), [&](const ParameterValue& value) {
      Parameters then = now;
      set_parameter(then, value);
      return then.valid();
    });
    if (next == left.end()) {
      std::string names;
      for (const ParameterValue& value : left) {
        names += names.empty() ? "" : ", ";
        names += kParameterTable[value.index].name;
      }
      throw InputError(names +
                       ": do not fit the robot's other parameters (a least value above "
                       "its greatest?); nothing was written");
    }
    set_parameter(now, *next);
    order.push_back(*next);
    left.erase(next);
  }
  return order;
}

}  // namespace screed
