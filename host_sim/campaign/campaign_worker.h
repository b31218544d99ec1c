// The worker of a campaign: its runs as tasks that a worker executes (task_worker.h).
#pragma once

#include <functional>
#include <iosfwd>
#include <string>

#include "host_sim/campaign/campaign_folder.h"
#include "host_sim/campaign/campaign_plan.h"
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

/// Answers requests until `requests` ends. Throws InputError when the folder has no plan.
void serve_campaign(const CampaignFolder& folder, const std::string& program_version,
                    const OptionsOfWorld& options_of_world, std::istream& requests,
                    const std::function<void(const std::string&)>& answer);

}  // namespace screed
