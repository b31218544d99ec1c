// What a subcommand is given when it registers itself.
//
// A subcommand is one file below tools/screed, NAME_command.cpp. It defines
//
//   void register_NAME_command(Command& parent, Program& program);
//
// which adds the subcommand to `parent` and, in its callback, sets `program.action` to what is to
// be run after parsing. tools/build/commands.sh lists the files in the generated commands.h, by
// name: GROUP_NAME_command.cpp beside GROUP_command.cpp belongs to `screed GROUP`, whose file calls
// register_GROUP_subcommands(); the others belong to `screed` itself.
#pragma once

#include <functional>
#include <string>

#include "tools/command_line/command.h"

namespace screed {

struct Program {
  std::string version;
  std::function<int()> action;  ///< set by the chosen subcommand; returns the exit code
};

}  // namespace screed
