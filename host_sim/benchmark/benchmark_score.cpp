// Scores out of the table of runs.
#include "host_sim/benchmark/benchmark_score.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <stdexcept>

#include "host_sim/benchmark/benchmark_file.h"
#include "host_sim/benchmark/run_column.h"

namespace screed {
namespace {

constexpr double kSecondsPerHour = 3600.0;
constexpr double kCm3PerM3 = 1e6;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// One figure of the runs of a course.
using Figure = std::function<double(std::size_t run)>;

/// When each run's relief was first half of what it began with [s]; NaN: never, or not known.
std::vector<double> half_times(std::size_t runs, const ValueTable& curves) {
  const RunColumn run_of(curves, "run");
  const RunColumn times(curves, "time");
  const RunColumn reliefs(curves, "relief");
  std::vector<double> begin(runs, kNone);
  std::vector<double> half(runs, kNone);
  for (std::size_t row = 0; row < curves.rows(); ++row) {
    const double relief = reliefs.at(row);
    if (std::isnan(relief)) continue;
    const auto run = static_cast<std::size_t>(run_of.at(row));
    if (std::isnan(begin.at(run))) begin[run] = relief;
    if (std::isnan(half[run]) && relief <= 0.5 * begin[run]) half[run] = times.at(row);
  }
  return half;
}

/// Mean of a cell's values by that of another's, over the seeds that have both.
std::optional<SeedMean> ratio(const MetricValues& values, std::size_t cell, std::size_t base) {
  std::vector<double> over;
  std::vector<double> under;
  for (std::size_t seed = 0; seed < values.seeds(); ++seed) {
    if (std::isnan(values.at(cell, seed)) || std::isnan(values.at(base, seed))) continue;
    over.push_back(values.at(cell, seed));
    under.push_back(values.at(base, seed));
  }
  const Interval interval = bootstrap_ratio_interval(over, under);
  if (std::isnan(interval.low)) return std::nullopt;
  return SeedMean{over.size(), mean_of(over) / mean_of(under), interval};
}

std::size_t column_of_entry(const CampaignPlan& plan) {
  const auto found =
      std::find_if(plan.factors.begin(), plan.factors.end(),
                   [](const CampaignFactor& factor) { return factor.heading == kEntryFactor; });
  if (found == plan.factors.end() || std::next(found) != plan.factors.end())
    throw std::logic_error("a benchmark's last factor is its entry");
  return static_cast<std::size_t>(found - plan.factors.begin());
}

}  // namespace

std::vector<CourseScore> score_benchmark(const CampaignPlan& plan, const ValueTable& runs,
                                         const ValueTable& curves, const std::string& baseline) {
  const std::size_t entry_column = column_of_entry(plan);
  const RunColumn before(runs, "terrain_before.relief_m");
  const RunColumn after(runs, "terrain_after.relief_m");
  const RunColumn rough_before(runs, "terrain_before.roughness_m");
  const RunColumn rough_after(runs, "terrain_after.roughness_m");
  const RunColumn progress(runs, "leveling.progress");
  const RunColumn energy(runs, "energy_j");
  const RunColumn per_joule(runs, "leveling.transport_per_joule_m4");
  const RunColumn stuck(runs, "leveling.stuck");
  const RunColumn left(runs, "left_bed");
  const RunColumn early(runs, "stopped_early");
  const RunColumn faults(runs, "faults");
  const std::vector<double> halves = half_times(plan.run_count(), curves);

  const auto course_of = [&](std::size_t cell) {
    return std::vector<std::string>(
        plan.cells[cell].begin(),
        plan.cells[cell].begin() + static_cast<std::ptrdiff_t>(entry_column));
  };
  std::vector<CourseScore> courses;
  for (std::size_t first = 0; first < plan.cells.size();) {
    std::size_t end = first;
    while (end < plan.cells.size() && course_of(end) == course_of(first)) ++end;
    CourseScore course;
    course.levels = course_of(first);
    course.duration_s = plan.durations_s[first];
    std::size_t base = end;
    for (std::size_t cell = first; cell < end; ++cell)
      if (plan.cells[cell][entry_column] == baseline) base = cell;
    const auto values_of = [&](const Figure& figure) {
      std::vector<double> values;
      for (std::size_t cell = first; cell < end; ++cell)
        for (std::size_t seed = 0; seed < plan.seed_count(); ++seed)
          values.push_back(figure(cell * plan.seed_count() + seed));
      return MetricValues(std::move(values), plan.seed_count());
    };
    const auto compare = [&](const Figure& figure) {
      return compare_cells(values_of(figure), base == end ? 0 : base - first);
    };
    const Figure change = [&](std::size_t run) { return after.at(run) / before.at(run) - 1.0; };
    const auto changes = compare(change);
    const auto rates = compare(
        [&](std::size_t run) { return -change(run) * kSecondsPerHour / course.duration_s; });
    const auto roughness =
        compare([&](std::size_t run) { return rough_after.at(run) / rough_before.at(run) - 1.0; });
    const auto progresses = compare([&](std::size_t run) { return progress.at(run); });
    const auto energies = compare([&](std::size_t run) { return energy.at(run); });
    const auto useful = compare([&](std::size_t run) { return per_joule.at(run) * kCm3PerM3; });
    const auto stucks = compare([&](std::size_t run) { return stuck.at(run); });
    for (std::size_t cell = first; cell < end; ++cell) {
      const std::size_t at = cell - first;
      EntryScore score;
      score.entry = plan.cells[cell][entry_column];
      score.runs = changes[at].value.count;
      score.failed = plan.seed_count() - score.runs;
      score.relief_change = changes[at].value;
      score.rate_per_h = rates[at].value;
      score.roughness_change = roughness[at].value;
      score.progress = progresses[at].value;
      score.energy_j = energies[at].value;
      score.transport_per_joule = useful[at].value;
      score.stuck = stucks[at].value;
      std::vector<double> reached;
      for (std::size_t seed = 0; seed < plan.seed_count(); ++seed) {
        const std::size_t run = cell * plan.seed_count() + seed;
        if (!std::isnan(halves[run])) reached.push_back(halves[run]);
        if (left.at(run) == 1.0 || early.at(run) == 1.0 || faults.says_other_than("none", run))
          ++score.ended_early;
      }
      score.halved = reached.size();
      if (2 * reached.size() >= plan.seed_count()) {
        std::sort(reached.begin(), reached.end());
        score.half_time_s = reached[(plan.seed_count() - 1) / 2];
      }
      if (base != end && cell != base) {
        score.against_baseline = changes[at].against_baseline;
        score.times_baseline = ratio(values_of(change), at, base - first);
      }
      course.entries.push_back(std::move(score));
    }
    courses.push_back(std::move(course));
    first = end;
  }
  return courses;
}

}  // namespace screed
