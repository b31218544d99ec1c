// `screed campaign plan FILE`: what a campaign would run, and what that costs.
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <system_error>

#include "host_sim/campaign/campaign_file.h"
#include "host_sim/core/figures.h"
#include "host_sim/engine/worker_pool.h"
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
  const CampaignFolder& get() const { return folder_; }

 private:
  CampaignFolder folder_;
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
    std::cout << "| key | unit | default | allowed | meaning |\n| --- | --- | --- | --- | --- |\n"
              << campaign_key_table();
    return 0;
  }
  if (arguments.campaign.file.empty()) throw UsageError("FILE is required", "screed campaign plan");
  catch_interrupts();
  const CampaignPlan plan = choose_campaign(arguments.campaign, version).plan;
  std::optional<Cost> cost;
  if (!arguments.no_trial) cost = cost_of(plan);
  const Json json = json_of(plan, cost);
  arguments.json ? print_json(json) : print_plan(json);
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

}  // namespace screed
