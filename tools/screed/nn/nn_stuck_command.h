// `screed nn stuck`: the robot's slip watch in seeded drives, and the training of its network.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace screed {

/// Behind `screed nn`, which is made when it is not there.
void register_nn_stuck_command(CLI::App& root, std::function<int()>& action);

}  // namespace screed
