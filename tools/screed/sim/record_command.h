// `screed record FILE...`: training sessions.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

namespace screed {

void register_record_command(CLI::App& root, const std::string& version,
                             std::function<int()>& action);

}  // namespace screed
