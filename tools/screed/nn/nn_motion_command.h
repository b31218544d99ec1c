// `screed nn motion|rollout`: networks of motion are trained, and driven beside the physics.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace screed {

/// Behind `screed nn`, which is made when it is not there.
void register_nn_motion_command(CLI::App& root, std::function<int()>& action);

}  // namespace screed
