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
#include <memory>
#include <string>
#include <type_traits>

#include "tools/command_line/command.h"

namespace screed {

struct Program {
  std::string version;
  std::function<int()> action;  ///< set by the chosen subcommand; returns the exit code
};

/// A subcommand, and what its options set; both live as long as its parent.
template <class Arguments>
struct Subcommand {
  Command& command;
  Arguments& arguments;
};

/// A subcommand that is `run(arguments)`, or `run(arguments, version)`, which returns the exit
/// code.
template <class Arguments, class Run>
Subcommand<Arguments> add_subcommand(Command& parent, Program& program, const std::string& name,
                                     const std::string& help, Run run) {
  Command* const command = parent.add_subcommand(name, help);
  const auto arguments = std::make_shared<Arguments>();
  command->callback([arguments, run, &program] {
    program.action = [arguments, run, &program] {
      if constexpr (std::is_invocable_v<Run, Arguments&, std::string&>) {
        return run(*arguments, program.version);
      } else {
        return run(*arguments);
      }
    };
  });
  return {*command, *arguments};
}

}  // namespace screed
