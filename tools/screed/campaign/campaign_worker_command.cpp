// `screed campaign worker FOLDER`: executes runs for `screed campaign run` and `screed grid`, which
// start it and ask for them on its standard input. Not for people.
#include <unistd.h>

#include <iostream>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "host_sim/campaign/campaign_run.h"
#include "host_sim/core/errors.h"
#include "host_sim/grid/grid_sweep.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/world_choice.h"

namespace screed {
namespace {

/// The options of every world, made once each: networks are read from files.
OptionsOfWorld make_options(const std::string& version) {
  auto known = std::make_shared<std::map<std::pair<std::string, std::string>, SimulationOptions>>();
  return [known, version](const CampaignWorld& world) {
    const auto [entry, is_new] = known->try_emplace({world.hal, world.board});
    if (is_new) {
      entry->second.program_version = version;
      WorldChoice choice;
      choice.hal = world.hal;
      choice.board = world.board;
      choose_world(choice, entry->second);
    }
    return entry->second;
  };
}

struct WorkerArguments {
  std::string folder;
  bool is_grid = false;
};

int run_worker(const WorkerArguments& arguments, const std::string& version) {
  // Standard output is for answers alone, whatever a library prints.
  const int answers = dup(STDOUT_FILENO);
  if (answers < 0 || dup2(STDERR_FILENO, STDOUT_FILENO) < 0)
    throw RunError("standard output cannot be redirected");
  const auto answer = [&](const std::string& text) {
    const std::string line = text + "\n";
    if (write(answers, line.data(), line.size()) < 0)
      throw RunError("whoever started this worker is gone");
  };
  if (arguments.is_grid) {
    serve_sweep({arguments.folder}, version, std::cin, answer);
  } else {
    serve_campaign({arguments.folder}, version, make_options(version), std::cin, answer);
  }
  return 0;
}

}  // namespace

void register_campaign_worker_command(Command& campaign, Program& program) {
  auto arguments = std::make_shared<WorkerArguments>();
  Command* command =
      campaign.add_subcommand("worker", "Execute runs for `screed campaign run` and `screed grid`");
  command->add_option("FOLDER", arguments->folder, "Folder of a campaign or sweep")->required();
  command->add_flag("--grid", arguments->is_grid, "The folder is that of a sweep of `screed grid`");
  command->callback([arguments, &program] {
    program.action = [arguments, version = program.version] {
      return run_worker(*arguments, version);
    };
  });
}

}  // namespace screed
