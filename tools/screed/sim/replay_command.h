// `screed replay RUN`: does this build still compute what was recorded?
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace screed {

/// Adds the subcommand; its callback sets `action` to what is to be run after parsing.
/// The action returns 0 when the outputs are identical and 1 when they differ; throws InputError
/// for a wrong RUN.
void register_replay_command(CLI::App& root, std::function<int()>& action);

}  // namespace screed
