// What a benchmark's runs say of each entry, course by course, with intervals, and how it differs
// from a baseline on the same beds.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/campaign/campaign_plan.h"
#include "host_sim/campaign/cell_comparison.h"
#include "host_sim/campaign/value_table.h"

namespace screed {

/// Means over the beds; the metrics are those of docs/leveling-metrics.md. A run that failed has no
/// figures; one that ended before its time keeps those of its end.
struct EntryScore {
  std::string entry;
  std::size_t runs = 0;    ///< with figures
  std::size_t failed = 0;  ///< without
  SeedMean relief_change;  ///< relief at the end by that at the start, less 1
  SeedMean rate_per_h;     ///< by how much of the start's the relief falls in an hour
  SeedMean roughness_change;
  SeedMean progress;             ///< of transport
  SeedMean energy_j;             ///< of all robots
  SeedMean transport_per_joule;  ///< cm3 m/J
  SeedMean stuck;                ///< share of the time
  std::size_t ended_early = 0;   ///< runs with a fault, or that left the bed
  std::size_t halved = 0;        ///< beds whose relief was half of its start's at some time
  /// When half of the beds had come to that [s]; NaN: fewer did, or no curves were kept.
  double half_time_s = std::numeric_limits<double>::quiet_NaN();
  /// Of the relief's change, less the baseline's; nothing for the baseline itself.
  std::optional<PairedDifference> against_baseline;
  /// Mean relief change by the baseline's, with its interval; nothing likewise, and where the
  /// baseline's change may be none.
  std::optional<SeedMean> times_baseline;
};

struct CourseScore {
  std::vector<std::string> levels;  ///< of kCourseFactors
  double duration_s = 0.0;
  std::vector<EntryScore> entries;  ///< in the order of the campaign
};

/// `plan`: of benchmark_campaign(); `runs`: its run_table(); `curves`: its curve_table().
/// `baseline`: an entry; without one that the plan has, nothing is compared.
std::vector<CourseScore> score_benchmark(const CampaignPlan& plan, const ValueTable& runs,
                                         const ValueTable& curves, const std::string& baseline);

}  // namespace screed
