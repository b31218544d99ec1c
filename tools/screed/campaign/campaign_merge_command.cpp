// `screed campaign merge FOLDER`: the results of a campaign as files for other programs.
#include <cstdio>
#include <iostream>
#include <memory>
#include <string>

#include "host_sim/campaign/campaign_results.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/json.h"
#include "tools/screed/campaign/campaign_work.h"
#include "tools/screed/cli/command.h"

namespace screed {
namespace {

struct MergeArguments {
  std::string folder;
  bool incomplete = false;
  bool json = false;
};

int run_merge(const MergeArguments& arguments) {
  const TaskFolder folder{arguments.folder};
  const CampaignPlan plan = read_plan(folder.plan());
  const ResultIndex results(folder.results());
  note_odd_results(plan, results);
  const CampaignCount count = count_results(plan, results);
  if (!count.complete() && !arguments.incomplete) {
    throw InputError(arguments.folder + ": " + count.text() +
                     "; statistics of an incomplete campaign mislead: run the rest, or say "
                     "--incomplete");
  }
  merge_and_note(plan, results, folder);
  if (arguments.json) {
    std::cout << Json({{"folder", arguments.folder},
                       {"runs", count.runs},
                       {"done", count.done},
                       {"failed", count.failed},
                       {"missing", count.missing()}})
                     .dump(2)
              << "\n";
  } else {
    std::printf("%s: %s; %s\n", plan.settings.name.c_str(), count.text().c_str(),
                (folder.path / "campaign.h5").c_str());
  }
  return 0;
}

}  // namespace

void register_campaign_merge_command(Command& campaign, Program& program) {
  auto arguments = std::make_shared<MergeArguments>();
  Command* command = campaign.add_subcommand(
      "merge", "Write the results of a campaign as HDF5 and CSV, one row per run");
  command->add_option("FOLDER", arguments->folder, "Folder of the campaign")->required();
  command->add_flag("--incomplete", arguments->incomplete,
                    "Merge although runs are missing or failed; their figures are left empty");
  command->add_flag("--json", arguments->json, "Print JSON");
  command->callback(
      [arguments, &program] { program.action = [arguments] { return run_merge(*arguments); }; });
}

}  // namespace screed
