// `screed campaign status FOLDER`: how far a campaign has come, and what went wrong in it.
#include <algorithm>
#include <iostream>
#include <string>
#include <vector>

#include "host_sim/campaign/campaign_merge.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/figures.h"
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
void print_jobs(const CampaignFolder& folder) {
  for (const SlurmJob& job : slurm_jobs(folder)) {
    try {
      if (const int tasks = slurm::active_tasks(job.number); tasks > 0)
        print("  job {}  {} tasks in the queue\n", job.number, tasks);
    } catch (const RunError& error) {
      std::cerr << "note: job " << job.number << ": " << error.what() << "\n";
    }
  }
}

int run_status(const StatusArguments& arguments) {
  const CampaignFolder folder{arguments.folder};
  const CampaignPlan plan = read_plan(folder.plan());
  const ResultIndex results(folder.results());
  note_odd_results(plan, results);
  const CampaignCount count = count_results(plan, results);
  const std::vector<Failure> failures = failures_of(plan, results);
  if (arguments.json) {
    print_json(json_of(plan, count, failures));
    return 0;
  }
  print("{}: {}\n", plan.settings.name, count.text());
  for (size_t i = 0; i < std::min(failures.size(), kFailedRunsShown); ++i)
    print("  run {}  {}\n", failures[i].run, failures[i].error);
  if (failures.size() > kFailedRunsShown)
    print("  and {} failed runs more\n", failures.size() - kFailedRunsShown);
  print_jobs(folder);
  return 0;
}

}  // namespace

void register_campaign_status_command(Command& campaign, Program& program) {
  auto [command, arguments] = add_subcommand<StatusArguments>(
      campaign, program, "status", "Show how far a campaign is and which runs failed", run_status);
  command.add_option("FOLDER", arguments.folder, "Folder of the campaign")->required();
  command.add_flag("--json", arguments.json, "Print JSON");
}

}  // namespace screed
