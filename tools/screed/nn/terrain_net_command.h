// `screed terrain-net`: trains networks that foretell what the robot does to the ground, and
// compares them with recorded runs.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace screed {

void register_terrain_net_command(CLI::App& root, std::function<int()>& action);

}  // namespace screed
