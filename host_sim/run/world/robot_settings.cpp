// The experiment's parameters and key, made each robot's own.
#include "host_sim/run/world/robot_settings.h"

#include "host_sim/run/experiment/board_table.h"
#include "host_sim/run/experiment/robot_sections.h"
#include "host_sim/run/world/robot_number.h"

namespace screed {

std::vector<RobotSettings> robot_settings(const Experiment& experiment, const std::string& board) {
  const BoardConstants& constants = board_constants_of(board);
  const Credentials credentials = credentials_of(experiment);
  std::vector<RobotSettings> settings;
  for (size_t i = 0; i < experiment.robots.count; ++i) {
    Parameters parameters = experiment_of_robot(experiment, i).parameters;
    if (!robot_has_own(experiment, i, "parameters", "random_seed"))
      parameters = parameters_of_robot(parameters, i);
    settings.push_back({constants, parameters, credentials_of_robot(credentials, i)});
  }
  return settings;
}

}  // namespace screed
