// Parameters in files.
#include "tools/screed/link/parameter_file.h"

#include <algorithm>
#include <set>

#include "firmware/parameters/parameters.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/ini_file.h"
#include "host_sim/run/experiment/experiment.h"
#include "tools/screed/cli/parameter_names.h"

namespace screed {
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
