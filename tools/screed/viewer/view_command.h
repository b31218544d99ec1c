// `screed view RUN`: looks at a recorded run, at any time of it.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace screed {

void register_view_command(CLI::App& root, std::function<int()>& action);

}  // namespace screed
