#include "host_sim/benchmark/world_ranking.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <utility>

#include "host_sim/benchmark/benchmark_file.h"
#include "host_sim/benchmark/run_column.h"
#include "host_sim/core/random.h"

namespace screed {
namespace {

/// Cells of a plan that differ from each other in the world alone.
struct Pair {
  std::vector<std::string> course;
  std::string entry;
  std::size_t reference;
  std::size_t other;
};

using Change = std::vector<double>;  // of relief, by run

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
  const RunColumn before(runs, "terrain_before.relief_m");
  const RunColumn after(runs, "terrain_after.relief_m");
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
