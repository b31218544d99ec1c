// --help of every program: one form, 80 columns wide.
#pragma once

#include <string>

#include "tools/command_line/command.h"

namespace screed {

/// The page of a program or of one of its subcommands.
std::string help_page(const Command& command);

}  // namespace screed
