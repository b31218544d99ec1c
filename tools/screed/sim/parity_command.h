// `screed parity FILE`: does the image compute what the host computes?
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace screed {

/// Adds the subcommand; its callback sets `action` to what is to be run after parsing.
/// The action returns 0 when no byte differs and 1 when one does.
void register_parity_command(CLI::App& root, std::function<int()>& action);

}  // namespace screed
