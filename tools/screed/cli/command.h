// What a subcommand is given when it registers itself.
//
// A subcommand is defined in a file *_command.cpp below tools/screed, alone or with its like, by
//
//   void register_NAME_command(Command& parent, Program& program);
//
// which adds the subcommand to `parent` (add_subcommand()). tools/build/commands.sh lists them in
// the generated commands.h, by name: GROUP_NAME in the folder of GROUP belongs to `screed GROUP`,
// which calls register_GROUP_subcommands(); the others belong to `screed` itself.
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
  command->callback([command, arguments, run, &program] {
    program.action = [command, arguments, run, &program] {
      try {
        if constexpr (std::is_invocable_v<Run, Arguments&, std::string&>) {
          return run(*arguments, program.version);
        } else {
          return run(*arguments);
        }
      } catch (const UsageError& error) {
        throw UsageError(error.what(), command->path());
      }
    };
  });
  return {*command, *arguments};
}

}  // namespace screed
