// What a campaign says of one metric: means of cells and of factors' levels, and differences
// between cells, all over the seeds, which are the same in each.
//
// A run that has no value (it failed, or its metric is not defined) leaves its pair out; how many
// there were stands beside every figure. Intervals are those of host_sim/core/statistics.h.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/campaign/campaign_plan.h"
#include "host_sim/campaign/campaign_results.h"
#include "host_sim/core/statistics.h"

namespace screed {

/// A mean over seeds with its 95 % interval.
struct SeedMean {
  std::size_t count = 0;  ///< seeds with a value
  double mean = std::numeric_limits<double>::quiet_NaN();
  Interval interval{};
};

/// A cell less the baseline, over the seeds that have a value in both.
struct PairedDifference {
  SeedMean difference;
  SignedRank test;
  double p_holm = 1.0;  ///< of all cells that are compared with that baseline
};

struct CellComparison {
  SeedMean value;
  std::optional<PairedDifference> against_baseline;  ///< nothing for the baseline itself
  /// Over the seeds in which every cell has a value, 1 the lowest; nothing where there is none.
  std::optional<MeanRank> rank;
};

/// Values of one metric, by run: seeds of the first cell, seeds of the second. NaN: none.
class MetricValues {
 public:
  /// Throws std::logic_error unless there is a value a run.
  MetricValues(std::vector<double> values, std::size_t seeds);

  std::size_t cells() const { return values_.size() / seeds_; }
  std::size_t seeds() const { return seeds_; }
  double at(std::size_t cell, std::size_t seed) const { return values_[cell * seeds_ + seed]; }
  const std::vector<double>& all() const { return values_; }

 private:
  std::vector<double> values_;
  std::size_t seeds_;
};

/// All cells, each beside the cell `baseline`.
std::vector<CellComparison> compare_cells(const MetricValues& values, std::size_t baseline);

/// The mean over those cells, seed by seed, and its interval over the seeds. Seeds without a value
/// in any of them are left out.
SeedMean mean_over_cells(const MetricValues& values, const std::vector<std::size_t>& cells);

/// A level of a factor, and its cells, in the order in which levels first occur.
struct FactorLevel {
  std::string value;
  std::vector<std::size_t> cells;
};
/// `cells`: values of factors, by cell and factor.
std::vector<FactorLevel> levels_of(const std::vector<std::vector<std::string>>& cells,
                                   std::size_t factor);

// How leveling goes on over time in each cell of a campaign: means over the seeds, with intervals.
//
// Runs are compared at the same times. A run that ended before keeps its last value: its ground
// stays as it was left. To leave it out instead would show only those that went well.

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
