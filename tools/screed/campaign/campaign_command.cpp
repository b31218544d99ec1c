// `screed campaign ...`: one experiment, run many times with other values and seeds.
#include "commands.h"
#include "tools/screed/cli/command.h"

namespace screed {

void register_campaign_command(Command& root, Program& program) {
  Command* campaign =
      root.add_subcommand("campaign", "Run an experiment many times with other values and seeds");
  register_campaign_subcommands(*campaign, program);
}

}  // namespace screed
