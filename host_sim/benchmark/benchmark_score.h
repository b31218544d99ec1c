// What a benchmark's runs say of each entry, course by course, with intervals, and how it differs
// from a baseline on the same beds; and whether another world orders the entries as the physics
// does.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/campaign/campaign_plan.h"
#include "host_sim/campaign/campaign_results.h"
#include "host_sim/campaign/cell_statistics.h"

namespace screed {

/// Means over the beds; the metrics are those of docs/leveling-metrics.md. A run that failed has no
/// figures; one that ended before its time keeps those of its end.
struct EntryScore {
  std::string entry;
  std::size_t runs = 0;    ///< with figures
  std::size_t failed = 0;  ///< without
  SeedMean level_change;   ///< height about level at the end by that at the start, less 1
  SeedMean progress;       ///< of transport, by W1
  SeedMean progress_w2;    ///< by W2, not squared
  SeedMean relief_change;  ///< as level_change
  SeedMean roughness_change;
  SeedMean height_change_m;      ///< of the mean height: what tracks press together
  SeedMean energy_j;             ///< of all robots
  SeedMean transport_per_joule;  ///< cm3 m/J
  SeedMean stuck;                ///< share of the time
  std::size_t ended_early = 0;   ///< runs with a fault, or that left the bed
  std::size_t halved = 0;  ///< beds whose height about level was half of its start's at some time
  /// When half of the beds had come to that [s]; NaN: fewer did, or no curves were kept.
  double half_time_s = std::numeric_limits<double>::quiet_NaN();
  /// Of level_change, less the baseline's; nothing for the baseline itself.
  std::optional<PairedDifference> against_baseline;
  /// Mean progress by the baseline's, with its interval; nothing likewise, and where the
  /// baseline's progress may be none.
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

// Whether another world orders the entries of the leveling benchmark as the physics does, and how
// far their rates agree: the benchmark's runs, course by course, in both worlds on the same beds.

/// One entry's change of the height about level in both worlds.
struct RankedEntry {
  std::string entry;
  SeedMean reference;
  SeedMean other;
};

/// Kendall's tau of the entries' mean changes of the height about level. Its interval is the
/// bootstrap's over the beds: what it says of other beds.
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
