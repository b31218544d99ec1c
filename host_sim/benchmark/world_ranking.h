// Whether another world orders the entries of the leveling benchmark as the physics does, and how
// far their rates agree: the benchmark's runs, course by course, in both worlds on the same beds.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "host_sim/campaign/campaign_plan.h"
#include "host_sim/campaign/cell_comparison.h"
#include "host_sim/campaign/value_table.h"

namespace screed {

/// One entry's change of relief in both worlds.
struct RankedEntry {
  std::string entry;
  SeedMean reference;
  SeedMean other;
};

/// Kendall's tau of the entries' mean changes of relief. Its interval is the bootstrap's over the
/// beds: what it says of other beds.
struct WorldRanking {
  std::string reference;  ///< level of kWorldFactor: the suite's first
  std::string other;
  std::vector<std::string> course;  ///< levels of kCourseFactors; empty: all courses together
  std::vector<RankedEntry> entries;
  SeedMean tau;  ///< `count`: beds that have a value of every entry in both worlds
  /// How well the reference repeats its own order: tau between its means over a half of the beds
  /// and over the other half, mean over 1,000 random halves of a fixed seed that order anything.
  /// NaN where none does. Where it is low, entries differ by little beside what beds do. It is no
  /// bound of `tau`, which is of all beds, and of the same ones in both worlds.
  double reference_halves = std::numeric_limits<double>::quiet_NaN();
};

/// Of each further world, each course, then all courses together where there are several. Nothing
/// for a plan with one world. `plan`: of benchmark_campaign(); `runs`: its run_table().
std::vector<WorldRanking> rank_worlds(const CampaignPlan& plan, const ValueTable& runs);

}  // namespace screed
