// `screed campaign run FILE`: executes what is missing of a campaign on this machine.
#include <chrono>
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/campaign/campaign_results.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/json.h"
#include "tools/screed/campaign/campaign_work.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/interrupt.h"
#include "tools/screed/cli/number_option.h"

namespace screed {
namespace {

using Clock = std::chrono::steady_clock;

struct RunArguments {
  CampaignChoice campaign;
  std::optional<int> workers;
  std::optional<std::string> shard;
  bool quiet = false;
  bool json = false;
};

Json json_of(const ChosenCampaign& campaign, const CampaignCount& count,
             const EngineOutcome& outcome, int workers, double seconds) {
  return {{"name", campaign.plan.settings.name},
          {"folder", campaign.folder.path.string()},
          {"runs", count.runs},
          {"done", count.done},
          {"failed", count.failed},
          {"missing", count.missing()},
          {"done_now", outcome.done},
          {"workers", workers},
          {"seconds", seconds}};
}

/// The task of a job array, beside others on this machine and elsewhere.
CampaignJob shard_job(const RunArguments& arguments, const ChosenCampaign& campaign) {
  CampaignJob job;
  job.trial = kept_trial(campaign.plan, campaign.folder);
  job.runs = read_shard(*arguments.shard, campaign.plan);
  return job;
}

int run_run(const RunArguments& arguments, const std::string& version) {
  catch_interrupts();
  const Clock::time_point begin = Clock::now();
  const ChosenCampaign campaign = choose_campaign(arguments.campaign, version);
  const CampaignPlan& plan = campaign.plan;
  std::optional<CampaignLock> lock;
  if (!arguments.shard.has_value()) lock.emplace(campaign.folder);
  CampaignJob job = arguments.shard.has_value() ? shard_job(arguments, campaign)
                                                : whole_job(campaign, arguments.quiet);
  job.workers = worker_count(arguments.workers, plan, job.trial);
  const EngineOutcome outcome = execute(campaign, job, arguments.quiet);
  const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();

  show_failures(outcome);
  const CampaignCount count = count_results(plan, ResultIndex(campaign.folder.results()), job.runs);
  if (arguments.json) {
    std::cout << json_of(campaign, count, outcome, job.workers, seconds).dump(2) << "\n";
  } else {
    std::printf("%s: %s; %zu now, in %.1f s with %d workers\n", plan.settings.name.c_str(),
                count.text().c_str(), outcome.done, seconds, job.workers);
    std::printf("  folder  %s\n", campaign.folder.path.c_str());
  }
  if (interrupted()) {
    std::cerr << "screed: stopped; the same command goes on\n";
    return interrupted_exit_code();
  }
  if (!outcome.stopped.empty()) throw RunError(outcome.stopped);
  return count.complete() ? 0 : 1;
}

}  // namespace

void register_campaign_run_command(Command& campaign, Program& program) {
  auto arguments = std::make_shared<RunArguments>();
  Command* command = campaign.add_subcommand(
      "run", "Execute what is missing of a campaign; interrupted, the same command goes on");
  command->add_option("FILE", arguments->campaign.file, "Campaign file (INI), or its folder")
      ->required();
  command
      ->add_option("--out", arguments->campaign.out, "Folder of the campaign (default: out/NAME)")
      ->type_name("FOLDER");
  add_number(*command, "--workers", arguments->workers,
             "Runs at a time (default: one on each processor, as many as memory allows)",
             {1, 4096});
  command
      ->add_option("--as-version", arguments->campaign.as_version,
                   "Count results of this version of Screed as this program's, and the other way "
                   "round")
      ->type_name("VERSION");
  command
      ->add_option("--shard", arguments->shard,
                   "Execute the runs in this line of a file alone, as a task of a job array")
      ->type_name("FILE:LINE");
  command->add_flag("--quiet", arguments->quiet, "Show no progress");
  command->add_flag("--json", arguments->json, "Print JSON");
  command->callback([arguments, &program] {
    program.action = [arguments, version = program.version] {
      return run_run(*arguments, version);
    };
  });
}

}  // namespace screed
