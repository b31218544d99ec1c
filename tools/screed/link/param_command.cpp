// `screed param`: parameters of a robot, or of an experiment, by their names and in units that
// people read. Exit codes: 0 done, 1 refused, no answer, or (diff) not the same, 2 wrong input; of
// diff, as diff(1) has it, 2 for all that is no comparison.
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "firmware/parameters/parameters.h"
#include "host_sim/core/atomic_file.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/json.h"
#include "host_sim/run/experiment/experiment.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/progress_bar.h"
#include "tools/screed/link/named_parameters.h"
#include "tools/screed/link/robot_link.h"

namespace screed {
namespace {

struct ParamArguments {
  LinkArguments link;
  std::vector<std::string> names;  ///< of get
  std::string name;                ///< of set
  std::string value;
  std::string file;
  std::optional<std::string> experiment;
  std::optional<std::string> out;
  bool json = false;
};

/// The robot at the link, met.
struct ParamRobot : RobotSession {
  explicit ParamRobot(const ParamArguments& arguments)
      : RobotSession(arguments.link, command_key(arguments.link)) {
    meet();
  }
};

const char* name_of(uint16_t index) {
  return kParameterTable[index].name;
}

/// What programs read of a value.
Json json_of(const ParameterValue& value) {
  Json json;
  json["name"] = name_of(value.index);
  json["value"] = value.value;
  json["text"] = parameter_text(value.index, value.value);
  return json;
}

/// As the robot has them; reading all takes some seconds by radio.
std::vector<ParameterValue> read_from(RobotSession& robot, const std::vector<uint16_t>& indices) {
  std::optional<ProgressBar> bar;
  if (isatty(STDERR_FILENO) == 1) bar.emplace(std::cerr);
  std::vector<ParameterValue> values;
  values.reserve(indices.size());
  for (const uint16_t index : indices) {
    values.push_back({index, static_cast<int16_t>(robot.read_parameter(index))});
    const double share = static_cast<double>(values.size()) / static_cast<double>(indices.size());
    if (bar.has_value()) bar->show_share(share, std::string("read ") + name_of(index));
  }
  if (bar.has_value()) bar->finish();
  return values;
}

Parameters read_all(RobotSession& robot) {
  std::vector<uint16_t> indices;
  for (const ParameterValue& value : all_parameters({})) indices.push_back(value.index);
  Parameters parameters;
  for (const ParameterValue& value : read_from(robot, indices)) set_parameter(parameters, value);
  return parameters;
}

int list(const ParamArguments& arguments) {
  Json json;
  std::size_t width = 0;
  for (const std::string& name : parameter_names()) width = std::max(width, name.size());
  for (const ParameterValue& value : all_parameters({})) {
    const ParameterInfo& info = kParameterTable[value.index];
    const bool live = changes_while_running(static_cast<uint8_t>(value.index));
    if (arguments.json) {
      Json row = {{"name", info.name}};
      row["default"] = value.value;
      row["min"] = info.min;
      row["max"] = info.max;
      row["unit"] = info.unit;
      row["meaning"] = info.meaning;
      row["live"] = live;
      json.push_back(row);
      continue;
    }
    const std::string name = info.name;
    std::cout << name << std::string(width + 2 - name.size(), ' ') << info.meaning << "\n"
              << std::string(width + 2, ' ') << parameter_range(value.index)
              << "; default: " << parameter_text(value.index, value.value) << (live ? "; live" : "")
              << "\n";
  }
  if (arguments.json) std::cout << json.dump(2) << "\n";
  return 0;
}

int get(const ParamArguments& arguments) {
  std::vector<uint16_t> indices;
  for (const std::string& name : arguments.names) indices.push_back(parameter_index(name));
  ParamRobot robot(arguments);
  const std::vector<ParameterValue> values =
      indices.empty() ? all_parameters(read_all(robot)) : read_from(robot, indices);
  Json json;
  for (const ParameterValue& value : values) {
    if (arguments.json) {
      json.push_back(json_of(value));
    } else {
      std::cout << name_of(value.index) << " = " << parameter_text(value.index, value.value)
                << "\n";
    }
  }
  if (arguments.json) std::cout << json.dump(2) << "\n";
  return 0;
}

/// Writes one, and says so: "climb_speed = 150 mm/s: done", behind what it was before.
bool write_to(RobotSession& robot, const ParameterValue& value, const std::string& before = "") {
  const std::string what =
      before + name_of(value.index) + " = " + parameter_text(value.index, value.value);
  return robot.say(what, robot.commands().write_parameter(value.index, value.value));
}

int set(const ParamArguments& arguments) {
  const uint16_t index = parameter_index(arguments.name);
  const int16_t value = parameter_value(index, arguments.value);
  ParamRobot robot(arguments);
  return write_to(robot, {index, value}) ? 0 : 1;
}

int dump(const ParamArguments& arguments) {
  std::string text;
  if (arguments.experiment.has_value()) {
    text = parameter_file_text(read_experiment(*arguments.experiment).parameters,
                               "Parameters of the experiment " + *arguments.experiment +
                                   "; screed param load FILE gives them to a robot.");
  } else {
    ParamRobot robot(arguments);
    text = parameter_file_text(read_all(robot),
                               "Parameters of a robot; screed param load FILE gives them to one, "
                               "screed sim FILE drives with them.");
  }
  if (arguments.out.has_value()) {
    write_file(*arguments.out, text);
  } else {
    std::cout << text;
  }
  return 0;
}

std::vector<uint16_t> indices_of(const std::vector<ParameterValue>& values) {
  std::vector<uint16_t> indices;
  indices.reserve(values.size());
  for (const ParameterValue& value : values) indices.push_back(value.index);
  return indices;
}

/// The same parameters of the robot, or of the other experiment.
std::vector<ParameterValue> others_of(const ParamArguments& arguments,
                                      const std::vector<ParameterValue>& values) {
  if (!arguments.experiment.has_value()) {
    ParamRobot robot(arguments);
    return read_from(robot, indices_of(values));
  }
  const Parameters parameters = read_experiment(*arguments.experiment).parameters;
  std::vector<ParameterValue> others;
  others.reserve(values.size());
  for (const uint16_t index : indices_of(values))
    others.push_back({index, get_parameter(parameters, index)});
  return others;
}

int diff(const ParamArguments& arguments) {
  const std::vector<ParameterValue> values = read_parameter_file(arguments.file);
  const std::vector<ParameterValue> others = others_of(arguments, values);
  const std::string other = arguments.experiment.value_or("the robot");
  Json json = Json::array();
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i] == others[i]) continue;
    Json row = {{"name", name_of(values[i].index)}};
    row["file"] = json_of(values[i])["text"];
    row["other"] = json_of(others[i])["text"];
    json.push_back(row);
    if (arguments.json) continue;
    std::cout << name_of(values[i].index) << ": "
              << parameter_text(values[i].index, values[i].value) << " in " << arguments.file
              << ", " << parameter_text(others[i].index, others[i].value) << " in " << other
              << "\n";
  }
  if (arguments.json) std::cout << json.dump(2) << "\n";
  return json.empty() ? 0 : 1;
}

int load(const ParamArguments& arguments) {
  const std::vector<ParameterValue> wanted = read_parameter_file(arguments.file);
  ParamRobot robot(arguments);
  const Parameters before = read_all(robot);
  const std::vector<ParameterValue> writes = writing_order(before, wanted);
  if (writes.empty()) {
    std::cout << "the robot has all " << wanted.size() << " of " << arguments.file << " already\n";
    return 0;
  }
  std::size_t written = 0;
  for (const ParameterValue& value : writes) {
    const std::string was = std::string(name_of(value.index)) + " was " +
                            parameter_text(value.index, get_parameter(before, value.index)) + "; ";
    if (!write_to(robot, value, was)) break;
    ++written;
  }
  std::vector<ParameterValue> done(writes.begin(),
                                   writes.begin() + static_cast<std::ptrdiff_t>(written));
  if (!done.empty() && read_from(robot, indices_of(done)) != done)
    throw RunError("the robot does not give back what was written; load again");
  std::cout << wanted.size() << " in " << arguments.file << ", " << writes.size() << " differed, "
            << written << " set and read back" << std::endl;
  if (written == writes.size()) return 0;
  throw RunError("not all parameters were set");
}

}  // namespace

void register_param_command(Command& root, Program& program) {
  auto arguments = std::make_shared<ParamArguments>();
  Command* command =
      root.add_subcommand("param", "Parameters of a robot: list, get, set, dump, compare, load");
  add_link_options(*command, arguments->link);
  add_key_option(*command, arguments->link);
  command->fallthrough();
  const auto add = [&](const char* name, const char* help, int (*run)(const ParamArguments&)) {
    Command* sub = command->add_subcommand(name, help);
    sub->fallthrough();
    sub->callback([arguments, &program, run] {
      program.action = [arguments, run] { return run(*arguments); };
    });
    return sub;
  };
  const auto json = [&](Command* sub) {
    sub->add_flag("--json", arguments->json, "Print the result as JSON, values as in the table");
  };
  const auto file = [&](Command* sub) {
    sub->add_option("FILE", arguments->file,
                    "Parameter file of screed param dump, or any experiment")
        ->type_name("FILE")
        ->required();
  };

  json(add("list",
           "List all parameters: meaning, range, default, and which change while a robot runs "
           "(live); needs no robot",
           list));

  Command* of_get = add("get", "Print parameters of the robot", get);
  of_get
      ->add_option("NAME", arguments->names,
                   "Names of the parameters, see screed param list (default: all)")
      ->suggest(parameter_names());
  json(of_get);

  Command* of_set = add("set", "Set a parameter and store it in the robot", set);
  of_set->add_option("NAME", arguments->name, "Name of the parameter, see screed param list")
      ->required()
      ->suggest(parameter_names());
  of_set
      ->add_option("VALUE", arguments->value,
                   "New value, as get prints it: 5, '5 deg', spin_on_peak")
      ->required();

  Command* of_dump = add("dump", "Print all parameters as a file for load and for sim", dump);
  of_dump
      ->add_option("--experiment", arguments->experiment,
                   "Parameters of this experiment instead of a robot")
      ->type_name("FILE");
  of_dump->add_option("--out", arguments->out, "File to write (default: standard output)")
      ->type_name("FILE");

  Command* of_diff = add("diff",
                         "Compare the parameters that FILE names with the robot's; exit code 1 "
                         "when they differ",
                         [](const ParamArguments& given) {
                           try {
                             return diff(given);
                           } catch (const RunError& error) {
                             throw InputError(error.what());
                           }
                         });
  file(of_diff);
  of_diff
      ->add_option("--experiment", arguments->experiment,
                   "Compare with this experiment instead of a robot")
      ->type_name("FILE");
  json(of_diff);

  file(add("load", "Set the robot's parameters that FILE names, where they differ", load));
}

}  // namespace screed
