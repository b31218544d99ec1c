// `screed level ...`: how well algorithms level, and the search for better ones.
#include "commands.h"
#include "tools/screed/cli/command.h"

namespace screed {

void register_level_command(CLI::App& root, Program& program) {
  CLI::App* level = root.add_subcommand("level", "Measure how well algorithms level");
  level->require_subcommand(1);
  register_level_subcommands(*level, program);
}

}  // namespace screed
