// `screed grid`: the grid world of thesis 4.2, one run or thousands.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

namespace screed {

/// Adds the subcommand; its callback sets `action` to what is to be run after parsing.
void register_grid_command(CLI::App& root, const std::string& version,
                           std::function<int()>& action);

}  // namespace screed
