// Scores of courses, and rankings of worlds.
#include "host_sim/benchmark/benchmark_score.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "host_sim/benchmark/benchmark_file.h"
#include "host_sim/campaign/campaign_results.h"
#include "host_sim/core/constants.h"
#include "host_sim/core/random.h"

namespace screed {
namespace {

constexpr double kCm3PerM3 = 1e6;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// One figure of the runs of a course.
using Figure = std::function<double(std::size_t run)>;

/// When each run's height about level was first half of what it began with [s]; NaN: never, or not
/// known.
std::vector<double> half_times(std::size_t runs, const ValueTable& curves) {
  const std::vector<double> run_of = curves.numbers("run");
  const std::vector<double> times = curves.numbers("time");
  const std::vector<double> heights = curves.numbers("level_deviation");
  std::vector<double> begin(runs, kNone);
  std::vector<double> half(runs, kNone);
  for (std::size_t row = 0; row < curves.rows(); ++row) {
    const double height = heights.at(row);
    if (std::isnan(height)) continue;
    const auto run = static_cast<std::size_t>(run_of.at(row));
    if (std::isnan(begin.at(run))) begin[run] = height;
    if (std::isnan(half[run]) && height <= 0.5 * begin[run]) half[run] = times.at(row);
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
  const auto change_of = [&](const std::string& figure) {
    std::vector<double> change = runs.numbers("terrain_after." + figure);
    const std::vector<double> before = runs.numbers("terrain_before." + figure);
    for (std::size_t run = 0; run < change.size(); ++run)
      change[run] = change[run] / before[run] - 1;
    return change;
  };
  const std::vector<double> level = change_of("level_deviation_m");
  const std::vector<double> relief = change_of("relief_m");
  const std::vector<double> roughness = change_of("roughness_m");
  const std::vector<double> height_before = runs.numbers("terrain_before.mean_height_m");
  const std::vector<double> height_after = runs.numbers("terrain_after.mean_height_m");
  const std::vector<double> progress = runs.numbers("leveling.progress");
  const std::vector<double> progress_w2 = runs.numbers("leveling.progress_w2");
  const std::vector<double> energy = runs.numbers("energy_j");
  const std::vector<double> per_joule = runs.numbers("leveling.transport_per_joule_m4");
  const std::vector<double> stuck = runs.numbers("leveling.stuck");
  const std::vector<double> left = runs.numbers("left_bed");
  const std::vector<double> early = runs.numbers("stopped_early");
  const std::vector<std::string> faults = runs.texts("faults");
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
    const auto values = [](const std::vector<double>& of) -> Figure {
      return [&of](std::size_t run) { return of.at(run); };
    };
    const auto levels = compare(values(level));
    const auto progresses = compare(values(progress));
    const auto progresses_w2 = compare(values(progress_w2));
    const auto reliefs = compare(values(relief));
    const auto roughnesses = compare(values(roughness));
    const auto heights =
        compare([&](std::size_t run) { return height_after.at(run) - height_before.at(run); });
    const auto energies = compare(values(energy));
    const auto useful = compare([&](std::size_t run) { return per_joule.at(run) * kCm3PerM3; });
    const auto stucks = compare(values(stuck));
    for (std::size_t cell = first; cell < end; ++cell) {
      const std::size_t at = cell - first;
      EntryScore score;
      score.entry = plan.cells[cell][entry_column];
      score.runs = levels[at].value.count;
      score.failed = plan.seed_count() - score.runs;
      score.level_change = levels[at].value;
      score.progress = progresses[at].value;
      score.progress_w2 = progresses_w2[at].value;
      score.relief_change = reliefs[at].value;
      score.roughness_change = roughnesses[at].value;
      score.height_change_m = heights[at].value;
      score.energy_j = energies[at].value;
      score.transport_per_joule = useful[at].value;
      score.stuck = stucks[at].value;
      std::vector<double> reached;
      for (std::size_t seed = 0; seed < plan.seed_count(); ++seed) {
        const std::size_t run = cell * plan.seed_count() + seed;
        if (!std::isnan(halves[run])) reached.push_back(halves[run]);
        if (left.at(run) == 1.0 || early.at(run) == 1.0 ||
            (!faults.at(run).empty() && faults.at(run) != "none"))
          ++score.ended_early;
      }
      score.halved = reached.size();
      if (2 * reached.size() >= plan.seed_count()) {
        std::sort(reached.begin(), reached.end());
        score.half_time_s = reached[(plan.seed_count() - 1) / 2];
      }
      if (base != end && cell != base) {
        score.against_baseline = levels[at].against_baseline;
        score.times_baseline = ratio(values_of(values(progress)), at, base - first);
      }
      course.entries.push_back(std::move(score));
    }
    courses.push_back(std::move(course));
    first = end;
  }
  return courses;
}

namespace {

/// Cells of a plan that differ from each other in the world alone.
struct Pair {
  std::vector<std::string> course;
  std::string entry;
  std::size_t reference;
  std::size_t other;
};

using Change = std::vector<double>;  // of the height about level, by run

std::vector<Pair> pairs_of(const CampaignPlan& plan, const std::string& reference,
                           const std::string& other) {
  std::vector<Pair> pairs;
  for (std::size_t a = 0; a < plan.cells.size(); ++a) {
    if (plan.cells[a][0] != reference) continue;
    for (std::size_t b = 0; b < plan.cells.size(); ++b) {
      if (plan.cells[b][0] != other ||
          !std::equal(plan.cells[a].begin() + 1, plan.cells[a].end(), plan.cells[b].begin() + 1)) {
        continue;
      }
      pairs.push_back({{plan.cells[a].begin() + 1, std::prev(plan.cells[a].end())},
                       plan.cells[a].back(),
                       a,
                       b});
    }
  }
  return pairs;
}

double mean_at(const Change& change, std::size_t first, const std::vector<std::size_t>& seeds) {
  double sum = 0.0;
  for (const std::size_t seed : seeds) sum += change[first + seed];
  return sum / static_cast<double>(seeds.size());
}

SeedMean mean_of_cell(const Change& change, std::size_t first,
                      const std::vector<std::size_t>& seeds) {
  std::vector<double> values;
  values.reserve(seeds.size());
  for (const std::size_t seed : seeds) values.push_back(change[first + seed]);
  return {values.size(), mean_of(values), bootstrap_mean_interval(values)};
}

std::vector<double> means_of_reference(const Change& change, const std::vector<Pair>& pairs,
                                       std::size_t count, const std::vector<std::size_t>& seeds) {
  std::vector<double> means;
  means.reserve(pairs.size());
  for (const Pair& pair : pairs) means.push_back(mean_at(change, pair.reference * count, seeds));
  return means;
}

double tau_of_halves(const Change& change, const std::vector<Pair>& pairs, std::size_t count,
                     std::vector<std::size_t> seeds) {
  constexpr int kHalves = 1000;
  if (seeds.size() < 2) return std::numeric_limits<double>::quiet_NaN();
  WorldRandom random(1, "halves of beds");
  const auto half = static_cast<std::ptrdiff_t>(seeds.size() / 2);
  std::vector<double> taus;
  taus.reserve(kHalves);
  for (int i = 0; i < kHalves; ++i) {
    for (std::size_t k = seeds.size() - 1; k > 0; --k) {
      const std::size_t other = (random.next() * std::uint64_t{k + 1}) >> 32U;
      std::swap(seeds[k], seeds[other]);
    }
    const auto middle = seeds.begin() + half;
    const double tau =
        kendall_tau(means_of_reference(change, pairs, count, {seeds.begin(), middle}),
                    means_of_reference(change, pairs, count, {middle, seeds.end()}));
    if (std::isfinite(tau)) taus.push_back(tau);
  }
  return mean_of(taus);
}

WorldRanking ranking_of(const CampaignPlan& plan, const Change& change,
                        const std::vector<Pair>& pairs) {
  const std::size_t count = plan.seed_count();
  std::vector<std::size_t> seeds;  // with a value everywhere
  for (std::size_t seed = 0; seed < count; ++seed) {
    if (std::all_of(pairs.begin(), pairs.end(), [&](const Pair& pair) {
          return std::isfinite(change[pair.reference * count + seed]) &&
                 std::isfinite(change[pair.other * count + seed]);
        })) {
      seeds.push_back(seed);
    }
  }
  WorldRanking ranking;
  for (const Pair& pair : pairs) {
    ranking.entries.push_back({pair.entry, mean_of_cell(change, pair.reference * count, seeds),
                               mean_of_cell(change, pair.other * count, seeds)});
  }
  const auto tau = [&](const std::vector<std::size_t>& chosen) {
    std::vector<std::size_t> beds;
    beds.reserve(chosen.size());
    for (const std::size_t one : chosen) beds.push_back(seeds[one]);
    std::vector<double> reference;
    std::vector<double> other;
    for (const Pair& pair : pairs) {
      reference.push_back(mean_at(change, pair.reference * count, beds));
      other.push_back(mean_at(change, pair.other * count, beds));
    }
    return kendall_tau(reference, other);
  };
  ranking.tau.count = seeds.size();
  if (seeds.empty()) return ranking;
  std::vector<std::size_t> all(seeds.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  ranking.tau.mean = tau(all);
  ranking.tau.interval = bootstrap_percentiles(seeds.size(), tau);
  ranking.reference_halves = tau_of_halves(change, pairs, count, seeds);
  return ranking;
}

}  // namespace

std::vector<WorldRanking> rank_worlds(const CampaignPlan& plan, const ValueTable& runs) {
  if (plan.factors.empty() || plan.factors.front().heading != kWorldFactor) return {};
  const std::vector<double> before = runs.numbers("terrain_before.level_deviation_m");
  const std::vector<double> after = runs.numbers("terrain_after.level_deviation_m");
  Change change(plan.run_count());
  for (std::size_t run = 0; run < change.size(); ++run) {
    change[run] = after.at(run) / before.at(run) - 1.0;
  }
  std::vector<std::string> worlds;
  for (const FactorLevel& level : levels_of(plan.cells, 0)) worlds.push_back(level.value);
  std::vector<WorldRanking> rankings;
  for (std::size_t world = 1; world < worlds.size(); ++world) {
    const std::vector<Pair> all = pairs_of(plan, worlds[0], worlds[world]);
    const auto add = [&](std::vector<std::string> course, const std::vector<Pair>& pairs) {
      WorldRanking ranking = ranking_of(plan, change, pairs);
      ranking.reference = worlds[0];
      ranking.other = worlds[world];
      ranking.course = std::move(course);
      rankings.push_back(std::move(ranking));
    };
    std::size_t courses = 0;
    for (std::size_t first = 0; first < all.size();) {
      std::size_t end = first;
      while (end < all.size() && all[end].course == all[first].course) ++end;
      add(all[first].course, {all.begin() + static_cast<std::ptrdiff_t>(first),
                              all.begin() + static_cast<std::ptrdiff_t>(end)});
      ++courses;
      first = end;
    }
    if (courses > 1) add({}, all);
  }
  return rankings;
}

}  // namespace screed
