// How leveling goes on over time in each cell of a campaign: means over the seeds, with intervals.
//
// Runs are compared at the same times. A run that ended before keeps its last value: its ground
// stays as it was left. To leave it out instead would show only those that went well.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "host_sim/campaign/campaign_plan.h"
#include "host_sim/campaign/cell_comparison.h"
#include "host_sim/campaign/value_table.h"

namespace screed {

struct CellCurve {
  std::string name;                          ///< of a column of curves.csv
  std::vector<double> times_s;               ///< rising
  std::vector<std::vector<SeedMean>> cells;  ///< by cell and time
};

/// At most that many times of a curve, spread evenly over those at which a run was measured.
inline constexpr std::size_t kMaxCurveTimes = 40;

/// Relief, roughness, flat share, progress and the share of time stuck, those of them that were
/// measured. `curves`: curve_table() of the same plan. Nothing where no curves were kept.
std::vector<CellCurve> cell_curves(const CampaignPlan& plan, const ValueTable& curves);

}  // namespace screed
