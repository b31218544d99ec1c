// `screed monitor`: what a robot says, live in a terminal or as text in a pipe, logged as candump
// does; and the ground station whose heartbeats keep the robot going.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace screed {

void register_monitor_command(CLI::App& root, std::function<int()>& action);

}  // namespace screed
