// Keys made of other keys.
#include "host_sim/run/experiment/robot_sections.h"

#include <algorithm>
#include <utility>

namespace screed {
namespace {

constexpr const char* kPrefix = "robot_";

bool is_of_place(const ExperimentKey& key) {
  return key.section == "vehicle" && (key.name == "x" || key.name == "y" || key.name == "h");
}

/// Whether a key can be another one for each robot.
bool is_of_one_robot(const ExperimentKey& key) {
  if (is_of_place(key) || key.section == "drive") return true;
  if (key.section == "experiment") return key.name == "algorithm";
  // Of the training drive, which is of one robot.
  return key.section == "parameters" && key.name != "training_block";
}

/// The key of a robot's section that stands for number `index` of experiment_keys().
ExperimentKey own_key(size_t robot, size_t index) {
  const ExperimentKey& of_all = experiment_keys()[index];
  ExperimentKey key = of_all;
  key.section = section_of_robot(robot);
  const KeyOfRobot place{robot, index};
  key.set = [place, &of_all](Experiment& experiment, const std::string& text) {
    Experiment tried;
    if (!of_all.set(tried, text)) return false;
    experiment.of_robots[place] = of_all.get(tried).value();
    return true;
  };
  key.get = [place](const Experiment& experiment) -> std::optional<std::string> {
    const auto own = experiment.of_robots.find(place);
    return own == experiment.of_robots.end() ? std::nullopt : std::optional(own->second);
  };
  return key;
}

std::vector<std::vector<ExperimentKey>> make_robot_keys() {
  std::vector<std::vector<ExperimentKey>> of_robots(kMaxRobots);
  for (size_t robot = 0; robot < kMaxRobots; ++robot) {
    for (size_t i = 0; i < experiment_keys().size(); ++i) {
      const ExperimentKey& key = experiment_keys()[i];
      if (robot == 0 ? is_of_place(key) : is_of_one_robot(key))
        of_robots[robot].push_back(own_key(robot, i));
    }
  }
  return of_robots;
}

}  // namespace

std::string section_of_robot(size_t robot) {
  return kPrefix + std::to_string(robot);
}

std::optional<size_t> robot_of_section(const std::string& section) {
  const std::string prefix = kPrefix;
  size_t robot = 0;
  if (section.rfind(prefix, 0) != 0 || !parse_number(section.substr(prefix.size()), robot) ||
      robot >= kMaxRobots || section != section_of_robot(robot)) {
    return std::nullopt;
  }
  return robot;
}

const std::vector<ExperimentKey>& robot_section_keys(size_t robot) {
  static const std::vector<std::vector<ExperimentKey>> table = make_robot_keys();
  return table.at(robot);
}

bool robot_has_own(const Experiment& experiment, size_t robot, const std::string& section,
                   const std::string& key) {
  return std::any_of(
      experiment.of_robots.begin(), experiment.of_robots.end(), [&](const auto& own) {
        const ExperimentKey& of_all = experiment_keys()[own.first.second];
        return own.first.first == robot && of_all.section == section && of_all.name == key;
      });
}

void apply_robot_section(Experiment& experiment, size_t robot) {
  const std::map<KeyOfRobot, std::string> of_robots = experiment.of_robots;
  for (const auto& [place, value] : of_robots) {
    if (place.first == robot) experiment_keys()[place.second].set(experiment, value);
  }
  experiment.parameters.algorithm() = algorithm_number(experiment.experiment.algorithm);
}

Experiment experiment_of_robot(const Experiment& experiment, size_t robot) {
  Experiment own = experiment;
  apply_robot_section(own, robot);
  return own;
}

std::string robot_section_table() {
  const auto row = [](const std::string& name, const std::string& unit, const std::string& allowed,
                      const std::string& meaning) {
    return "| [robot_N] " + name + " | " + unit + " |  | " + allowed + " | " + meaning + " |\n";
  };
  std::string text;
  for (const ExperimentKey& key : experiment_keys()) {
    if (!is_of_one_robot(key) || key.section == "parameters") continue;
    text += row(key.name, key.unit, key.allowed,
                "robot N: in place of [" + key.section + "] " + key.name);
  }
  return text + row("a key of [parameters]", "", "as there", "robot N: in place of that");
}

}  // namespace screed
