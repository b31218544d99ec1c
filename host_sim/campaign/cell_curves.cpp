#include "host_sim/campaign/cell_curves.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

namespace screed {
namespace {

constexpr std::array<std::string_view, 5> kShown = {"progress", "relief", "roughness",
                                                    "robot_scale_flatness", "stuck"};

/// One figure of one run over time: where it was measured, times rising.
using RunCurve = std::vector<std::pair<double, double>>;

const ValueTable::ValueColumn* find_column(const ValueTable& table, std::string_view name) {
  const auto found =
      std::find_if(table.columns().begin(), table.columns().end(),
                   [name](const ValueTable::ValueColumn& column) { return column.name == name; });
  return found == table.columns().end() ? nullptr : &*found;
}

/// By run.
std::vector<RunCurve> run_curves(const CampaignPlan& plan, const ValueTable& table,
                                 const ValueTable::ValueColumn& column) {
  const ValueTable::ValueColumn& runs = *find_column(table, "run");
  const ValueTable::ValueColumn& times = *find_column(table, "time");
  std::vector<RunCurve> curves(plan.run_count());
  for (std::size_t row = 0; row < column.values.size(); ++row) {
    if (!column.values[row].is_number()) continue;
    curves.at(runs.values[row].get<std::size_t>())
        .emplace_back(times.values[row].get<double>(), column.values[row].get<double>());
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
  for (const std::string_view name : kShown) {
    const ValueTable::ValueColumn* const column = find_column(curves, name);
    if (column == nullptr) continue;
    const std::vector<RunCurve> of_runs = run_curves(plan, curves, *column);
    std::vector<double> times_s = common_times(of_runs);
    if (times_s.size() < 2) continue;
    auto cells = means_of_cells(plan, of_runs, times_s);
    shown.push_back({std::string(name), std::move(times_s), std::move(cells)});
  }
  return shown;
}

}  // namespace screed
