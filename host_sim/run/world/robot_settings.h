// What the firmware of each robot of an experiment is given at its start.
#pragma once

#include <string>
#include <vector>

#include "firmware/parameters/board_constants.h"
#include "firmware/parameters/parameters.h"
#include "firmware/security/credentials.h"
#include "host_sim/run/experiment/experiment.h"

namespace screed {

struct RobotSettings {
  BoardConstants board;
  Parameters parameters;
  Credentials credentials;
};

/// Of all robots, in their order, on a board of this name. Throws InputError for an unknown one.
std::vector<RobotSettings> robot_settings(const Experiment& experiment, const std::string& board);

}  // namespace screed
