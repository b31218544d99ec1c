// Storing a calibration.
#include "tools/screed/link/store_calibration.h"

#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/core/name_list.h"
#include "host_sim/core/task_progress.h"
#include "tools/screed/cli/parameter_names.h"

namespace screed {
namespace {

constexpr char kNothing[] = "; nothing was changed";

struct NamedValue {
  std::string name;
  uint16_t index;
  int16_t value;
};

std::vector<NamedValue> checked_values(const ImuCalibration& calibration) {
  std::vector<NamedValue> values;
  try {
    for (const CalibrationParameter& parameter : calibration_parameters(calibration)) {
      const uint16_t index = parameter_index(parameter.name);
      values.push_back({parameter.name, index, checked_parameter(index, parameter.value)});
    }
  } catch (const InputError& error) {
    throw RunError(error.what() + std::string(kNothing));
  }
  return values;
}

/// The end of a message about a calibration of which `count` values are stored.
std::string stored_text(const std::vector<NamedValue>& values, std::size_t count) {
  if (count == 0) return kNothing;
  std::vector<std::string> names;
  names.reserve(count);
  for (std::size_t i = 0; i < count; ++i) names.push_back(values[i].name);
  return "; stored: " + name_list(names, ", ") + "; not stored: the other " +
         std::to_string(values.size() - count) + "; calibrate again";
}

void store(const NamedValue& value, const ParameterWriter& robot, std::ostream& out) {
  robot.wait_until_ready();
  const std::optional<CommandAnswer> answer = robot.write(value.index, value.value);
  const std::string words = answer.has_value() ? robot.words(*answer) : "no answer";
  out << value.name << " = " << parameter_text(value.index, value.value) << ": " << words
      << std::endl;
  if (words != "done") throw RunError(value.name + " was not stored");
}

}  // namespace

void store_calibration(const ImuCalibration& calibration, const ParameterWriter& robot,
                       std::ostream& out) {
  const std::vector<NamedValue> values = checked_values(calibration);
  for (std::size_t i = 0; i < values.size(); ++i) {
    try {
      store(values[i], robot, out);
    } catch (const RunError& error) {
      throw RunError(error.what() + stored_text(values, i));
    } catch (const TaskStopped& stopped) {
      throw TaskStopped(stopped.what() + stored_text(values, i));
    }
  }
}

}  // namespace screed
