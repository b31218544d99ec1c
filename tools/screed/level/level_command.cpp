// `screed level ...`: how well algorithms level, and the search for better ones.
#include "commands.h"
#include "tools/screed/cli/command.h"

namespace screed {

void register_level_command(Command& root, Program& program) {
  Command* level = root.add_subcommand("level", "Measure how well algorithms level");
  register_level_subcommands(*level, program);
}

}  // namespace screed
