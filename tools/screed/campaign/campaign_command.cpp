// `screed campaign ...`: one experiment, run many times with other values and seeds. Here: plan,
// run, merge and worker.
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "commands.h"
#include "host_sim/campaign/campaign_file.h"
#include "host_sim/campaign/campaign_results.h"
#include "host_sim/campaign/campaign_run.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/figures.h"
#include "host_sim/engine/task_engine.h"
#include "host_sim/grid/grid_sweep.h"
#include "tools/screed/campaign/campaign_work.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/interrupt.h"
#include "tools/screed/cli/key_table.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/cli/world_choice.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

// ---- plan: what a campaign would run, and what that costs ----

constexpr double kSecondsPerHour = 3600.0;
constexpr size_t kLevelsShown = 6;

struct PlanArguments {
  CampaignChoice campaign;
  bool list_keys = false;
  bool no_trial = false;
  bool json = false;
};

/// What the runs take, as far as a trial can say.
struct Cost {
  double core_hours = 0.0;
  double longest_s = 0.0;  ///< of a single run
  double memory_mb = 0.0;  ///< of a worker
  int workers = 1;         ///< that this machine has processors for
};

/// A folder for a trial, gone with this object.
class TrialFolder {
 public:
  TrialFolder()
      : folder_{fs::temp_directory_path() / ("screed-plan-" + std::to_string(getpid()))} {}
  TrialFolder(const TrialFolder&) = delete;
  TrialFolder& operator=(const TrialFolder&) = delete;
  ~TrialFolder() {
    std::error_code ignored;
    fs::remove_all(folder_.path, ignored);
  }
  const TaskFolder& get() const { return folder_; }

 private:
  TaskFolder folder_;
};

/// Of all runs.
double simulated_hours(const CampaignPlan& plan) {
  return std::accumulate(plan.durations_s.begin(), plan.durations_s.end(), 0.0) *
         static_cast<double>(plan.seed_count()) / kSecondsPerHour;
}

Cost cost_of(const CampaignPlan& plan) {
  const TrialFolder folder;
  save_plan(plan, folder.get());
  const CampaignTrial trial = find_trial(plan, folder.get(), false);
  Cost cost;
  cost.memory_mb = trial.memory_mb;
  cost.workers = workers_that_fit(trial.memory_mb, usable_processors());
  for (const double duration : plan.durations_s) {
    cost.core_hours +=
        trial.mean_s(duration) * static_cast<double>(plan.seed_count()) / kSecondsPerHour;
    cost.longest_s = std::max(cost.longest_s, trial.greatest_s(duration));
  }
  return cost;
}

/// The values that a factor has, each once.
std::vector<std::string> levels_of(const CampaignPlan& plan, size_t factor) {
  std::vector<std::string> levels;
  std::set<std::string> seen;
  for (const std::vector<std::string>& cell : plan.cells)
    if (seen.insert(cell[factor]).second) levels.push_back(cell[factor]);
  return levels;
}

std::string levels_text(const Json& levels) {
  std::string text;
  for (size_t i = 0; i < std::min(levels.size(), kLevelsShown); ++i)
    text += (i == 0 ? "" : ", ") + levels[i].text();
  if (levels.size() > kLevelsShown) text += ", ... (" + std::to_string(levels.size()) + " values)";
  return text;
}

Json json_of(const CampaignPlan& plan, const std::optional<Cost>& cost) {
  Json factors = Json::array();
  for (size_t i = 0; i < plan.factors.size(); ++i)
    factors.push_back({{"keys", plan.factors[i].heading}, {"values", levels_of(plan, i)}});
  Json json = {{"name", plan.settings.name},
               {"version", plan.version},
               {"cells", plan.cells.size()},
               {"seeds", plan.seed_count()},
               {"runs", plan.run_count()},
               {"factors", factors},
               {"keep", keep_name(plan.settings.keep)},
               {"simulated_hours", simulated_hours(plan)}};
  if (cost.has_value()) {
    json.update({{"core_hours", cost->core_hours},
                 {"longest_run_s", cost->longest_s},
                 {"memory_mb", cost->memory_mb},
                 {"workers", cost->workers}});
  }
  return json;
}

void print_plan(const Json& json) {
  const auto row = [&](const std::string& name, const char* text) {
    print("  {:-34s} {}\n", name, filled(text, json));
  };
  print("{name}: {cells} cells x {seeds} seeds = {runs} runs\n", json);
  for (const Json& factor : json["factors"])
    print("  {:-34s} {}\n", factor["keys"], levels_text(factor["values"]));
  row("kept of a run", "{keep}");
  row("simulated time", "{simulated_hours:.3g} h");
  if (!json.contains("core_hours")) return;
  row("cost, from a trial", "{core_hours:.3g} h of a core");
  print("  {:-34s} {:.3g} h with {} workers\n", "  on this machine",
        json["core_hours"].get<double>() / json["workers"].get<int>(), json["workers"]);
  row("  longest run", "{longest_run_s:.3g} s");
  row("memory of a worker", "{memory_mb:.0f} MB");
}

int run_plan(const PlanArguments& arguments, const std::string& version) {
  if (arguments.list_keys) {
    print_key_table(campaign_key_table());
    return 0;
  }
  if (arguments.campaign.file.empty()) throw UsageError("FILE is required");
  catch_interrupts();
  const CampaignPlan plan = choose_campaign(arguments.campaign, version).plan;
  std::optional<Cost> cost;
  if (!arguments.no_trial) cost = cost_of(plan);
  const Json json = json_of(plan, cost);
  arguments.json ? print_json(json) : print_plan(json);
  return 0;
}

// ---- run: what is missing of a campaign, on this machine ----

using Clock = std::chrono::steady_clock;

struct RunArguments {
  CampaignChoice campaign;
  std::optional<int> workers;
  std::optional<std::string> shard;
  bool quiet = false;
  bool json = false;
};

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
  if (!arguments.quiet) note_work(campaign, job);
  const EngineOutcome outcome = execute(campaign, job, arguments.quiet);
  const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();

  show_failures(outcome);
  const CampaignCount count = count_results(plan, ResultIndex(campaign.folder.results()), job.runs);
  const Json json = {{"name", plan.settings.name}, {"folder", campaign.folder.path.string()},
                     {"runs", count.runs},         {"done", count.done},
                     {"failed", count.failed},     {"missing", count.missing()},
                     {"done_now", outcome.done},   {"workers", job.workers},
                     {"seconds", seconds}};
  if (arguments.json) {
    print_json(json);
  } else {
    print("{name}: " + count.text() +
              "; {done_now} now, in {seconds:.1f} s with {workers} workers\n"
              "  folder  {folder}\n",
          json);
  }
  if (interrupted()) {
    std::cerr << "screed: stopped; the same command goes on\n";
    return interrupted_exit_code();
  }
  if (!outcome.stopped.empty()) throw RunError(outcome.stopped);
  return count.complete() ? 0 : 1;
}

// ---- merge: the results as files for other programs ----

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
    print_json({{"folder", arguments.folder},
                {"runs", count.runs},
                {"done", count.done},
                {"failed", count.failed},
                {"missing", count.missing()}});
  } else {
    print("{}: {}; {}\n", plan.settings.name, count.text(), folder.path / "campaign.h5");
  }
  return 0;
}

// ---- worker: runs for `screed campaign run` and `screed grid`, which start it and ask for them on
// its standard input; not for people ----

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

void register_campaign_plan_command(Command& campaign, Program& program) {
  auto [command, arguments] = add_subcommand<PlanArguments>(
      campaign, program, "plan", "Show what a campaign would run and what that costs", run_plan);
  command.add_option("FILE", arguments.campaign.file, "Campaign file (INI), or its folder");
  command.add_flag("--no-trial", arguments.no_trial, "Do not try runs; the cost is not shown");
  command.add_flag("--keys", arguments.list_keys, "List the keys of a campaign file and exit");
  command.add_flag("--json", arguments.json, "Print JSON");
}

void register_campaign_run_command(Command& campaign, Program& program) {
  auto [command, arguments] = add_subcommand<RunArguments>(
      campaign, program, "run",
      "Execute what is missing of a campaign; interrupted, the same command goes on", run_run);
  command.add_option("FILE", arguments.campaign.file, "Campaign file (INI), or its folder")
      ->required();
  command.add_option("--out", arguments.campaign.out, "Folder of the campaign (default: out/NAME)")
      ->type_name("FOLDER");
  add_number(command, "--workers", arguments.workers,
             "Runs at a time (default: one on each processor, as many as memory allows)",
             {1, 4096});
  command
      .add_option("--as-version", arguments.campaign.as_version,
                  "Count results of this version of Screed as this program's, and the other way "
                  "round")
      ->type_name("VERSION");
  command
      .add_option("--shard", arguments.shard,
                  "Execute the runs in this line of a file alone, as a task of a job array")
      ->type_name("FILE:LINE");
  command.add_flag("--quiet", arguments.quiet, "Show no progress");
  command.add_flag("--json", arguments.json, "Print JSON");
}

void register_campaign_merge_command(Command& campaign, Program& program) {
  auto [command, arguments] = add_subcommand<MergeArguments>(
      campaign, program, "merge",
      "Write the results of a campaign as HDF5 and CSV, one row per run", run_merge);
  command.add_option("FOLDER", arguments.folder, "Folder of the campaign")->required();
  command.add_flag("--incomplete", arguments.incomplete,
                   "Merge although runs are missing or failed; their figures are left empty");
  command.add_flag("--json", arguments.json, "Print JSON");
}

void register_campaign_worker_command(Command& campaign, Program& program) {
  auto [command, arguments] = add_subcommand<WorkerArguments>(
      campaign, program, "worker", "Execute runs for `screed campaign run` and `screed grid`",
      run_worker);
  command.add_option("FOLDER", arguments.folder, "Folder of a campaign or sweep")->required();
  command.add_flag("--grid", arguments.is_grid, "The folder is that of a sweep of `screed grid`");
}

void register_campaign_command(Command& root, Program& program) {
  Command* campaign =
      root.add_subcommand("campaign", "Run an experiment many times with other values and seeds");
  register_campaign_subcommands(*campaign, program);
}

}  // namespace screed
