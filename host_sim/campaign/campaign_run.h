// Executes the runs of a campaign that are not finished yet, on the processors of this machine:
// the campaign's runs as tasks of the engine (task_engine.h).
#pragma once

#include <functional>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/campaign/campaign_plan.h"
#include "host_sim/engine/task_engine.h"
#include "host_sim/engine/task_folder.h"
#include "host_sim/run/simulation/simulation.h"

namespace screed {

/// What a run costs on this machine, as a trial of it shows.
struct RunCost {
  double setup_s = 0.0;       ///< of the clock, until the first tick
  double per_second_s = 0.0;  ///< of the clock, for a simulated second
  double finish_s = 0.0;      ///< of the clock, after the last tick

  double of(double simulated_s) const { return setup_s + per_second_s * simulated_s + finish_s; }
};

/// As a worker answers it, and back. Throws RunError for what is none.
std::string cost_text(const RunCost& cost);
RunCost parse_cost(const std::string& text);

/// The options with which the runs of a world are made; version and board are set already.
using OptionsOfWorld = std::function<SimulationOptions(const CampaignWorld&)>;

/// The worker of a campaign (task_worker.h): answers requests until `requests` ends. Throws
/// InputError when the folder has no plan.
void serve_campaign(const TaskFolder& folder, const std::string& program_version,
                    const OptionsOfWorld& options_of_world, std::istream& requests,
                    const std::function<void(const std::string&)>& answer);

/// What a trial of some runs has shown on this machine.
struct CampaignTrial {
  std::string host;            ///< where; empty: here
  std::vector<RunCost> costs;  ///< of the runs that were tried
  double memory_mb = 0.0;      ///< most that a worker had

  /// Of a run of so many simulated seconds: mean over those tried, and the greatest.
  double mean_s(double simulated_s) const;
  double greatest_s(double simulated_s) const;
};

/// Tries runs of a few cells, in one worker; the folder has the plan. A run that cannot be executed
/// costs nothing here. Throws TaskStopped when told to stop, RunError when no run can be tried.
CampaignTrial try_campaign(const CampaignPlan& plan, const EngineOptions& options);

/// Time of the clock that a run may take: the campaign's, or ten times what the trial says and a
/// minute.
double time_limit_s(const CampaignPlan& plan, size_t run,
                    const std::optional<CampaignTrial>& trial);

struct CampaignJob {
  std::vector<size_t> runs;  ///< to be executed, those that are done already included
  int workers = 1;
  std::optional<CampaignTrial> trial;
  std::function<void(const EngineProgress&)> progress;
};

/// Runs are begun seed by seed, each seed in all cells. Throws as run_tasks() does.
EngineOutcome run_campaign(const CampaignPlan& plan, const EngineOptions& options,
                           const CampaignJob& job);

}  // namespace screed
