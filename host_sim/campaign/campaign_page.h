// A campaign as one HTML page: a metric at a time over cells, factors and seeds, how the runs
// ended, the runs. What the page does with it is in tools/report.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "host_sim/campaign/campaign_plan.h"
#include "host_sim/campaign/campaign_results.h"
#include "host_sim/engine/task_folder.h"

namespace screed {

struct CampaignPageOptions {
  std::filesystem::path built_page;   ///< page.html of the build
  std::size_t baseline = 0;           ///< cell that the others are compared with
  std::optional<std::string> metric;  ///< shown first; left out: how far leveling has come
  std::filesystem::path link_base;    ///< folder of the page, from which its links lead
};

/// The page. `runs`, `curves`: run_table() and curve_table() of the same plan. The same campaign
/// and options give the same bytes. Throws InputError for a cell or metric that the campaign does
/// not have, and when there is no built page.
std::string campaign_page(const CampaignPlan& plan, const CampaignCount& count,
                          const ValueTable& runs, const ValueTable& curves,
                          const TaskFolder& folder, const CampaignPageOptions& options);

}  // namespace screed
