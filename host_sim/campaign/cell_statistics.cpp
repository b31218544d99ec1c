// Comparisons of cells, and curves over time.
#include "host_sim/campaign/cell_statistics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace screed {

namespace {

SeedMean seed_mean(const std::vector<double>& values) {
  return {values.size(), mean_of(values), bootstrap_mean_interval(values)};
}

std::vector<double> defined(const MetricValues& values, std::size_t cell) {
  std::vector<double> result;
  for (std::size_t seed = 0; seed < values.seeds(); ++seed) {
    if (!std::isnan(values.at(cell, seed))) result.push_back(values.at(cell, seed));
  }
  return result;
}

PairedDifference difference(const MetricValues& values, std::size_t cell, std::size_t baseline) {
  std::vector<double> differences;
  for (std::size_t seed = 0; seed < values.seeds(); ++seed) {
    const double by = values.at(cell, seed) - values.at(baseline, seed);
    if (!std::isnan(by)) differences.push_back(by);
  }
  return {seed_mean(differences), signed_rank(differences)};
}

/// One row a seed that has all values.
std::vector<std::vector<double>> complete_rows(const MetricValues& values) {
  std::vector<std::vector<double>> rows;
  for (std::size_t seed = 0; seed < values.seeds(); ++seed) {
    std::vector<double> row(values.cells());
    for (std::size_t cell = 0; cell < row.size(); ++cell) row[cell] = values.at(cell, seed);
    if (std::none_of(row.begin(), row.end(), [](double value) { return std::isnan(value); }))
      rows.push_back(std::move(row));
  }
  return rows;
}

void adjust_for_number(std::vector<CellComparison>& cells) {
  std::vector<double> p;
  for (const CellComparison& cell : cells) {
    if (cell.against_baseline) p.push_back(cell.against_baseline->test.p);
  }
  const std::vector<double> adjusted = holm(p);
  auto next = adjusted.begin();
  for (CellComparison& cell : cells) {
    if (cell.against_baseline) cell.against_baseline->p_holm = *next++;
  }
}

}  // namespace

MetricValues::MetricValues(std::vector<double> values, std::size_t seeds)
    : values_(std::move(values)), seeds_(seeds) {
  if (seeds_ == 0 || values_.size() % seeds_ != 0)
    throw std::logic_error("a metric has a value a run");
}

std::vector<CellComparison> compare_cells(const MetricValues& values, std::size_t baseline) {
  std::vector<CellComparison> result(values.cells());
  for (std::size_t cell = 0; cell < result.size(); ++cell) {
    result[cell].value = seed_mean(defined(values, cell));
    if (cell != baseline) result[cell].against_baseline = difference(values, cell, baseline);
  }
  adjust_for_number(result);
  const std::vector<MeanRank> ranks = mean_ranks(complete_rows(values));
  for (std::size_t cell = 0; cell < ranks.size(); ++cell) result[cell].rank = ranks[cell];
  return result;
}

SeedMean mean_over_cells(const MetricValues& values, const std::vector<std::size_t>& cells) {
  std::vector<double> means;
  for (std::size_t seed = 0; seed < values.seeds(); ++seed) {
    std::vector<double> of_seed;
    for (const std::size_t cell : cells) {
      if (!std::isnan(values.at(cell, seed))) of_seed.push_back(values.at(cell, seed));
    }
    if (!of_seed.empty()) means.push_back(mean_of(of_seed));
  }
  return seed_mean(means);
}

std::vector<FactorLevel> levels_of(const std::vector<std::vector<std::string>>& cells,
                                   std::size_t factor) {
  std::vector<FactorLevel> levels;
  for (std::size_t cell = 0; cell < cells.size(); ++cell) {
    const std::string& value = cells[cell][factor];
    auto level = std::find_if(levels.begin(), levels.end(),
                              [&value](const FactorLevel& it) { return it.value == value; });
    if (level == levels.end()) level = levels.insert(level, {value, {}});
    level->cells.push_back(cell);
  }
  return levels;
}

namespace {

constexpr std::array<const char*, 5> kShown = {"level_deviation", "progress", "relief", "roughness",
                                               "stuck"};

/// One figure of one run over time: where it was measured, times rising.
using RunCurve = std::vector<std::pair<double, double>>;

/// By run.
std::vector<RunCurve> run_curves(const CampaignPlan& plan, const ValueTable& table,
                                 const std::string& column) {
  const std::vector<double> runs = table.numbers("run");
  const std::vector<double> times = table.numbers("time");
  const std::vector<double> values = table.numbers(column);
  std::vector<RunCurve> curves(plan.run_count());
  for (std::size_t row = 0; row < values.size(); ++row) {
    if (std::isnan(values[row])) continue;
    curves.at(static_cast<std::size_t>(runs[row])).emplace_back(times[row], values[row]);
  }
  return curves;
}

std::vector<double> common_times(const std::vector<RunCurve>& curves) {
  std::vector<double> all;
  for (const RunCurve& curve : curves) {
    for (const auto& [time_s, value] : curve) all.push_back(time_s);
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  if (all.size() <= kMaxCurveTimes) return all;
  std::vector<double> some(kMaxCurveTimes);
  for (std::size_t i = 0; i < some.size(); ++i)
    some[i] = all[i * (all.size() - 1) / (some.size() - 1)];
  return some;
}

/// The last value up to that time; NaN before the first.
double value_at(const RunCurve& curve, double time_s) {
  const auto next =
      std::upper_bound(curve.begin(), curve.end(), time_s,
                       [](double time, const auto& point) { return time < point.first; });
  return next == curve.begin() ? std::numeric_limits<double>::quiet_NaN() : std::prev(next)->second;
}

std::vector<std::vector<SeedMean>> means_of_cells(const CampaignPlan& plan,
                                                  const std::vector<RunCurve>& curves,
                                                  const std::vector<double>& times_s) {
  std::vector<std::vector<SeedMean>> cells(plan.cells.size());
  for (const double time_s : times_s) {
    std::vector<double> values(curves.size());
    for (std::size_t run = 0; run < values.size(); ++run)
      values[run] = value_at(curves[run], time_s);
    const MetricValues at_time(std::move(values), plan.seed_count());
    for (std::size_t cell = 0; cell < cells.size(); ++cell)
      cells[cell].push_back(mean_over_cells(at_time, {cell}));
  }
  return cells;
}

}  // namespace

std::vector<CellCurve> cell_curves(const CampaignPlan& plan, const ValueTable& curves) {
  std::vector<CellCurve> shown;
  for (const char* const name : kShown) {
    const std::vector<RunCurve> of_runs = run_curves(plan, curves, name);
    std::vector<double> times_s = common_times(of_runs);
    if (times_s.size() < 2) continue;
    auto cells = means_of_cells(plan, of_runs, times_s);
    shown.push_back({name, std::move(times_s), std::move(cells)});
  }
  return shown;
}

}  // namespace screed
