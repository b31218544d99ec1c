// `screed soil plate|wheel|robot|repose|dig`: the reference tests of the deformable soil.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace screed {

/// Adds the subcommand; its callback sets `action` to what is to be run after parsing.
void register_soil_command(CLI::App& root, std::function<int()>& action);

}  // namespace screed
