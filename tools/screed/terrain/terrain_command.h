// `screed terrain generate`: height maps of made-up terrain.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace screed {

void register_terrain_command(CLI::App& root, std::function<int()>& action);

}  // namespace screed
