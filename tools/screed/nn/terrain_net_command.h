// `screed terrain-net`: trains networks that predict what the robot does to the terrain, and
// compares them with recorded runs.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace screed {

void register_terrain_net_command(CLI::App& root, std::function<int()>& action);

}  // namespace screed
