// Man pages made from the command tree.
#pragma once

#include <string>

#include "tools/command_line/command_tree.h"

namespace screed {

/// The page of the program itself, with a list of its subcommands.
std::string roff_page(const CommandNode& root, const std::string& version);

/// The page of a subcommand of the program, with those below it.
std::string roff_page(const CommandNode& root, const CommandNode& subcommand,
                      const std::string& version);

/// "screed-session" of "screed session": what the page is called.
std::string page_name(const CommandNode& node);

}  // namespace screed
