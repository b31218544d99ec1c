// `screed send`: one command to a robot, and its answer in words.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace screed {

void register_send_command(CLI::App& root, std::function<int()>& action);

}  // namespace screed
