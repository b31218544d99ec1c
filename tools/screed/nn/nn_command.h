// `screed nn ...`: networks from recorded sessions to the robot.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace screed {

/// `screed nn`, made when it is not there: other files put commands of their own under it.
CLI::App* nn_command(CLI::App& root);

void register_nn_command(CLI::App& root, std::function<int()>& action);

}  // namespace screed
