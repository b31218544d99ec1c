// `screed session info|export RUN`: what a recorded run holds, and its content as files that other
// programs read.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace screed {

void register_session_command(CLI::App& root, std::function<int()>& action);

}  // namespace screed
