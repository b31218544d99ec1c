// Executes the runs of a campaign that are not finished yet, on the processors of this machine:
// the campaign's runs as tasks of the engine (task_engine.h).
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/campaign/campaign_plan.h"
#include "host_sim/campaign/campaign_worker.h"
#include "host_sim/engine/task_engine.h"

namespace screed {

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
