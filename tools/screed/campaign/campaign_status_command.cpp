// `screed campaign status FOLDER`: how far a campaign has come, and what went wrong in it.
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "host_sim/campaign/campaign_results.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/json.h"
#include "tools/screed/campaign/campaign_work.h"
#include "tools/screed/campaign/slurm.h"
#include "tools/screed/cli/command.h"

namespace screed {
namespace {

constexpr size_t kFailedRunsShown = 10;

struct StatusArguments {
  std::string folder;
  bool json = false;
};

struct Failure {
  size_t run;
  std::string error;
};

std::vector<Failure> failures_of(const CampaignPlan& plan, const ResultIndex& results) {
  std::vector<Failure> failures;
  for (size_t run = 0; run < plan.run_count(); ++run) {
    if (!results.failed(plan.ids[run])) continue;
    const Json result = Json::parse(results.read(plan.ids[run]).result);
    failures.push_back({run, result.value("error", "")});
  }
  return failures;
}

Json json_of(const CampaignPlan& plan, const CampaignCount& count,
             const std::vector<Failure>& failures) {
  Json list = Json::array();
  for (const Failure& failure : failures)
    list.push_back({{"run", failure.run}, {"error", failure.error}});
  return {{"name", plan.settings.name},   {"version", plan.version}, {"runs", count.runs},
          {"done", count.done},           {"failed", count.failed},  {"missing", count.missing()},
          {"complete", count.complete()}, {"failures", list}};
}

/// Results are worth showing when Slurm does not answer, too.
void print_jobs(const TaskFolder& folder) {
  for (const SlurmJob& job : slurm_jobs(folder)) {
    try {
      if (const int tasks = slurm::active_tasks(job.number); tasks > 0)
        std::printf("  job %s  %d tasks in the queue\n", job.number.c_str(), tasks);
    } catch (const RunError& error) {
      std::cerr << "note: job " << job.number << ": " << error.what() << "\n";
    }
  }
}

int run_status(const StatusArguments& arguments) {
  const TaskFolder folder{arguments.folder};
  const CampaignPlan plan = read_plan(folder.plan());
  const ResultIndex results(folder.results());
  note_odd_results(plan, results);
  const CampaignCount count = count_results(plan, results);
  const std::vector<Failure> failures = failures_of(plan, results);
  if (arguments.json) {
    std::cout << json_of(plan, count, failures).dump(2) << "\n";
    return 0;
  }
  std::printf("%s: %s\n", plan.settings.name.c_str(), count.text().c_str());
  for (size_t i = 0; i < std::min(failures.size(), kFailedRunsShown); ++i)
    std::printf("  run %zu  %s\n", failures[i].run, failures[i].error.c_str());
  if (failures.size() > kFailedRunsShown)
    std::printf("  and %zu failed runs more\n", failures.size() - kFailedRunsShown);
  print_jobs(folder);
  return 0;
}

}  // namespace

void register_campaign_status_command(Command& campaign, Program& program) {
  auto arguments = std::make_shared<StatusArguments>();
  Command* command =
      campaign.add_subcommand("status", "Show how far a campaign is and which runs failed");
  command->add_option("FOLDER", arguments->folder, "Folder of the campaign")->required();
  command->add_flag("--json", arguments->json, "Print JSON");
  command->callback(
      [arguments, &program] { program.action = [arguments] { return run_status(*arguments); }; });
}

}  // namespace screed
