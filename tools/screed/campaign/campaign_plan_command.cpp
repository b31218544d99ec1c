// `screed campaign plan FILE`: what a campaign would run, and what that costs.
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <system_error>

#include "host_sim/campaign/campaign_file.h"
#include "host_sim/core/json.h"
#include "host_sim/engine/task_engine.h"
#include "tools/screed/campaign/campaign_work.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/interrupt.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

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

std::string levels_text(const std::vector<std::string>& levels) {
  std::string text;
  for (size_t i = 0; i < std::min(levels.size(), kLevelsShown); ++i)
    text += (i == 0 ? "" : ", ") + levels[i];
  if (levels.size() > kLevelsShown) text += ", ... (" + std::to_string(levels.size()) + " values)";
  return text;
}

void print_table(const CampaignPlan& plan, const std::optional<Cost>& cost) {
  std::printf("%s: %zu cells x %zu seeds = %zu runs\n", plan.settings.name.c_str(),
              plan.cells.size(), plan.seed_count(), plan.run_count());
  for (size_t i = 0; i < plan.factors.size(); ++i)
    std::printf("  %-34s %s\n", plan.factors[i].heading.c_str(),
                levels_text(levels_of(plan, i)).c_str());
  std::printf("  %-34s %s\n", "kept of a run", keep_name(plan.settings.keep));
  std::printf("  %-34s %.3g h\n", "simulated time", simulated_hours(plan));
  if (!cost.has_value()) return;
  std::printf("  %-34s %.3g h of a core\n", "cost, from a trial", cost->core_hours);
  std::printf("  %-34s %.3g h with %d workers\n", "  on this machine",
              cost->core_hours / cost->workers, cost->workers);
  std::printf("  %-34s %.3g s\n", "  longest run", cost->longest_s);
  std::printf("  %-34s %.0f MB\n", "memory of a worker", cost->memory_mb);
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
    json["core_hours"] = cost->core_hours;
    json["longest_run_s"] = cost->longest_s;
    json["memory_mb"] = cost->memory_mb;
    json["workers"] = cost->workers;
  }
  return json;
}

int run_plan(const PlanArguments& arguments, const std::string& version) {
  catch_interrupts();
  const CampaignPlan plan = choose_campaign(arguments.campaign, version).plan;
  std::optional<Cost> cost;
  if (!arguments.no_trial) cost = cost_of(plan);
  if (arguments.json) {
    std::cout << json_of(plan, cost).dump(2) << "\n";
  } else {
    print_table(plan, cost);
  }
  return 0;
}

}  // namespace

void register_campaign_plan_command(Command& campaign, Program& program) {
  auto arguments = std::make_shared<PlanArguments>();
  Command* command =
      campaign.add_subcommand("plan", "Show what a campaign would run and what that costs");
  command->add_option("FILE", arguments->campaign.file, "Campaign file (INI), or its folder");
  command->add_flag("--no-trial", arguments->no_trial, "Do not try runs; the cost is not shown");
  command->add_flag("--keys", arguments->list_keys, "List the keys of a campaign file and exit");
  command->add_flag("--json", arguments->json, "Print JSON");
  command->callback([arguments, &program] {
    if (arguments->list_keys) {
      program.action = [] {
        std::cout
            << "| key | unit | default | allowed | meaning |\n| --- | --- | --- | --- | --- |\n"
            << campaign_key_table();
        return 0;
      };
      return;
    }
    if (arguments->campaign.file.empty()) throw UsageError("FILE is required");
    program.action = [arguments, version = program.version] {
      return run_plan(*arguments, version);
    };
  });
}

}  // namespace screed
