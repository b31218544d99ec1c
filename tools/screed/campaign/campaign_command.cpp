// `screed campaign ...`: one experiment, run many times with other values and seeds.
#include "commands.h"
#include "tools/screed/cli/command.h"

namespace screed {

void register_campaign_command(CLI::App& root, Program& program) {
  CLI::App* campaign =
      root.add_subcommand("campaign", "Run an experiment many times with other values and seeds");
  campaign->require_subcommand(1);
  register_campaign_subcommands(*campaign, program);
}

}  // namespace screed
