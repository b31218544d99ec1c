// `screed render`: one frame of a recorded run as a ray-traced picture.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace screed {

/// Adds the subcommand to `root`. When it was chosen, parsing sets `action` to what is to be run;
/// that returns the exit code.
void register_render_command(CLI::App& root, std::function<int()>& action);

}  // namespace screed
