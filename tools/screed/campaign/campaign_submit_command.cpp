// `screed campaign submit FILE --slurm`: what is missing of a campaign as a job array, a task for
// each shard of runs; `screed campaign status FOLDER`: how far a campaign has come, what went wrong
// in it, and which of its jobs are in the queue.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "host_sim/campaign/campaign_results.h"
#include "host_sim/core/atomic_file.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/figures.h"
#include "tools/screed/campaign/campaign_work.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/interrupt.h"
#include "tools/screed/cli/number_option.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

// ---- submit ----

constexpr double kTask_s =
    600.0;  ///< that a task shall take: long beside Slurm's own second or two
constexpr int kMaxShard = 500;
constexpr double kSlurmMemoryMargin = 1.5;
constexpr double kBaseMemory_mb = 100.0;  ///< of the process that starts the worker
constexpr double kTimeFactor = 3.0;       ///< nodes differ

struct SubmitArguments {
  CampaignChoice campaign;
  bool slurm = false;
  bool dry_run = false;
  std::vector<std::string> options;
};

using Shards = std::vector<std::vector<size_t>>;

/// Runs in the order in which they are begun elsewhere: seed by seed.
std::vector<size_t> missing_runs(const CampaignPlan& plan, const ResultIndex& results) {
  std::vector<size_t> missing;
  for (size_t seed = 0; seed < plan.seed_count(); ++seed) {
    for (size_t cell = 0; cell < plan.cells.size(); ++cell) {
      const size_t run = cell * plan.seed_count() + seed;
      if (!results.done(plan.ids[run])) missing.push_back(run);
    }
  }
  return missing;
}

double mean_run_s(const CampaignPlan& plan, const std::vector<size_t>& runs,
                  const CampaignTrial& trial) {
  double sum = 0.0;
  for (const size_t run : runs) sum += trial.mean_s(plan.duration_of(run));
  return sum / static_cast<double>(runs.size());
}

/// No more tasks than an array may have.
Shards make_shards(const CampaignPlan& plan, const std::vector<size_t>& runs,
                   const CampaignTrial& trial, int max_tasks) {
  const double by_time = kTask_s / std::max(mean_run_s(plan, runs, trial), 1e-3);
  auto size = static_cast<size_t>(
      plan.settings.shard.value_or(static_cast<int>(std::clamp<double>(by_time, 1.0, kMaxShard))));
  const auto tasks = static_cast<size_t>(max_tasks);
  size = std::max(size, (runs.size() + tasks - 1) / tasks);
  Shards shards;
  for (size_t first = 0; first < runs.size(); first += size) {
    const size_t last = std::min(first + size, runs.size());
    shards.emplace_back(runs.begin() + static_cast<std::ptrdiff_t>(first),
                        runs.begin() + static_cast<std::ptrdiff_t>(last));
  }
  return shards;
}

/// What a task may take at most: one hanging run must not cost it the others.
double shard_limit_s(const CampaignPlan& plan, const std::vector<size_t>& shard,
                     const CampaignTrial& trial) {
  double sum = 0.0;
  double longest = 0.0;
  for (const size_t run : shard) {
    sum += kTimeFactor * trial.greatest_s(plan.duration_of(run));
    longest = std::max(longest, time_limit_s(plan, run, trial));
  }
  return sum + longest * (1.0 + plan.settings.retries);
}

/// A line a shard, the numbers of its runs.
std::string shards_text(const Shards& shards) {
  std::string text;
  for (const std::vector<size_t>& shard : shards) {
    for (size_t i = 0; i < shard.size(); ++i)
      text += (i == 0 ? "" : " ") + std::to_string(shard[i]);
    text += '\n';
  }
  return text;
}

std::string script_text(const SubmitArguments& arguments, const ChosenCampaign& campaign,
                        const Shards& shards, const CampaignTrial& trial, const fs::path& folder) {
  const CampaignPlan& plan = campaign.plan;
  double limit_s = 0.0;
  for (const std::vector<size_t>& shard : shards)
    limit_s = std::max(limit_s, shard_limit_s(plan, shard, trial));
  const double memory_mb =
      kBaseMemory_mb + plan.settings.memory_mb.value_or(kSlurmMemoryMargin * trial.memory_mb);
  std::string text =
      "#!/bin/bash\n# Tasks of a campaign: each executes what is missing of its "
      "shard. Made by `screed campaign submit`.\n";
  const auto option = [&](const std::string& words) { text += "#SBATCH " + words + "\n"; };
  option("--job-name=" + plan.settings.name);
  option("--array=0-" + std::to_string(shards.size() - 1));
  option("--ntasks=1");
  option("--cpus-per-task=1");
  option("--mem=" + std::to_string(static_cast<long>(std::ceil(memory_mb))) + "M");
  option("--time=" + slurm::time_text(limit_s));
  option("--requeue");
  option("--open-mode=append");
  option("--output=\"" + (folder / "%a.log").string() + "\"");
  for (const std::string& words : arguments.options) option(words);
  const std::string program = fs::read_symlink("/proc/self/exe").string();
  text += "exec " + slurm::quoted(program) + " campaign run " +
          slurm::quoted(campaign.folder.path.string()) + " --quiet --workers 1 --shard " +
          slurm::quoted((folder / "shards").string()) + ":\"$SLURM_ARRAY_TASK_ID\"";
  if (arguments.campaign.as_version.has_value())
    text += " --as-version " + slurm::quoted(*arguments.campaign.as_version);
  return text + "\n";
}

/// The first name that is free: 0001, 0002, ...
fs::path new_submission(const TaskFolder& folder) {
  for (int number = 1;; ++number) {
    std::error_code error;
    fs::path path = folder.slurm() / filled("{:04.0f}", number);
    fs::create_directories(folder.slurm(), error);
    if (fs::create_directory(path, error)) return path;
    if (error) throw RunError(path.string() + ": cannot be made: " + error.message());
  }
}

/// Two jobs would execute the same runs.
void refuse_while_active(const TaskFolder& folder) {
  for (const SlurmJob& job : slurm_jobs(folder)) {
    const int tasks = slurm::active_tasks(job.number);
    if (tasks == 0) continue;
    throw InputError("job " + job.number + " of this campaign has " +
                     counted(static_cast<std::uint64_t>(tasks), "task") +
                     " in the queue; wait for its end, or end it with scancel " + job.number);
  }
}

int run_submit(const SubmitArguments& arguments, const std::string& version) {
  if (!arguments.slurm) throw InputError("submit needs --slurm, the one kind of cluster it knows");
  catch_interrupts();
  const ChosenCampaign campaign = choose_campaign(arguments.campaign, version);
  const CampaignLock lock(campaign.folder);
  const int max_tasks = std::max(1, slurm::max_array_size() - 1);  // the size is one more
  refuse_while_active(campaign.folder);
  save_plan(campaign.plan, campaign.folder);
  const ResultIndex results(campaign.folder.results());
  note_odd_results(campaign.plan, results);
  const std::vector<size_t> runs = missing_runs(campaign.plan, results);
  if (runs.empty()) {
    print("{}: {}; nothing to submit\n", campaign.plan.settings.name,
          count_results(campaign.plan, results).text());
    return 0;
  }
  const CampaignTrial trial = find_trial(campaign.plan, campaign.folder, true);
  const Shards shards = make_shards(campaign.plan, runs, trial, max_tasks);
  const fs::path folder = new_submission(campaign.folder);
  const std::string script = (folder / "array.sh").string();
  write_file(folder / "shards", shards_text(shards));
  write_file(script, script_text(arguments, campaign, shards, trial, folder));
  if (arguments.dry_run) {
    print("{} in {}; script {}\n", counted(runs.size(), "run"), counted(shards.size(), "task"),
          script);
    return 0;
  }
  const std::string job = slurm::submit(script);
  write_file(folder / "job", job + "\n");
  print("{}: job {}, {} in {}\n  folder  {}\n", campaign.plan.settings.name, job,
        counted(runs.size(), "run"), counted(shards.size(), "task"), campaign.folder.path);
  return 0;
}

// ---- status ----

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
        print("  job {}  {} in the queue\n", job.number,
              counted(static_cast<std::uint64_t>(tasks), "task"));
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

void register_campaign_submit_command(Command& campaign, Program& program) {
  auto [command, arguments] = add_subcommand<SubmitArguments>(
      campaign, program, "submit",
      "Submit what is missing of a campaign to a cluster as a job array", run_submit);
  command.add_option("FILE", arguments.campaign.file, "Campaign file (INI), or its folder")
      ->required();
  command.add_flag("--slurm", arguments.slurm, "The cluster has Slurm");
  command
      .add_option("--out", arguments.campaign.out,
                  "Folder of the campaign, which all nodes see (default: out/NAME)")
      ->type_name("FOLDER");
  command
      .add_option("--option", arguments.options,
                  "An option for sbatch, such as --option=--partition=long; may be repeated")
      ->type_name("OPTION")
      ->one_value_each();
  command.add_flag("--dry-run", arguments.dry_run, "Write the script and do not submit it");
  command
      .add_option("--as-version", arguments.campaign.as_version,
                  "Count results of this version of Screed as this program's")
      ->type_name("VERSION");
}

void register_campaign_status_command(Command& campaign, Program& program) {
  auto [command, arguments] = add_subcommand<StatusArguments>(
      campaign, program, "status", "Show how far a campaign is and which runs failed", run_status);
  command.add_option("FOLDER", arguments.folder, "Folder of the campaign")->required();
  command.add_flag("--json", arguments.json, "Print JSON");
}

}  // namespace screed
