// What a user typed, read as a command line (command.h says what one may be).
#pragma once

#include <string>
#include <vector>

#include "tools/command_line/command.h"

namespace screed {

/// Reads the words behind the program's name: fills the targets of its options, then calls the
/// callback of the subcommand and of those above it. Returns what the user asked for by --help or
/// --version in place of that; empty: nothing. Throws UsageError.
std::string parse(Command& program, const std::vector<std::string>& words);

}  // namespace screed
