// `screed nn ...`: networks from recorded sessions to the robot.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace screed {

void register_nn_command(CLI::App& root, std::function<int()>& action);

}  // namespace screed
