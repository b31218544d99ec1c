#include "host_sim/core/paired_statistics.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <numeric>

#include "host_sim/core/quantile.h"
#include "host_sim/core/random.h"

namespace screed {
namespace {

constexpr int kSamples = 10'000;
constexpr std::uint64_t kSeed = 1;
constexpr double kTail = 0.025;
constexpr std::size_t kMaxExact = 200;

double normal_share_below(double z) {
  return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

/// The inverse, within +-38: what a double can tell from 0 and 1.
double normal_quantile(double share) {
  double low = -38.0;
  double high = 38.0;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (normal_share_below(middle) < share ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Means of samples with replacement, rising.
std::vector<double> resampled_means(const std::vector<double>& values) {
  WorldRandom random(kSeed, "bootstrap");
  const auto count = static_cast<std::uint64_t>(values.size());
  std::vector<double> means(kSamples);
  for (double& mean : means) {
    double sum = 0.0;
    for (std::uint64_t i = 0; i < count; ++i) sum += values[(random.next() * count) >> 32U];
    mean = sum / static_cast<double>(count);
  }
  std::sort(means.begin(), means.end());
  return means;
}

/// How the standard error of the mean changes with the mean, from leaving out one value each.
double acceleration(const std::vector<double>& values, double mean) {
  double squares = 0.0;
  double cubes = 0.0;
  for (const double value : values) {
    const double d = value - mean;
    squares += d * d;
    cubes += d * d * d;
  }
  return cubes / (6.0 * std::pow(squares, 1.5));
}

/// Ranks of values from 1 on, doubled so that the mean ranks of equal ones are integers too.
std::vector<int> doubled_ranks(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&values](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  std::vector<int> ranks(values.size());
  for (std::size_t begin = 0; begin < order.size();) {
    std::size_t end = begin + 1;
    while (end < order.size() && values[order[end]] == values[order[begin]]) ++end;
    // Ranks begin + 1 to end; their mean, doubled.
    for (std::size_t i = begin; i < end; ++i) ranks[order[i]] = static_cast<int>(begin + 1 + end);
    begin = end;
  }
  return ranks;
}

/// Chance of a sum of signed ranks as far from its mean or farther, each sign as likely as the
/// other.
double exact_p(const std::vector<int>& ranks, int rising) {
  const int all = std::accumulate(ranks.begin(), ranks.end(), 0);
  std::vector<double> chance(static_cast<std::size_t>(all) + 1, 0.0);
  chance[0] = 1.0;
  int reached = 0;
  for (const int rank : ranks) {
    for (int sum = reached; sum >= 0; --sum) {
      const auto from = static_cast<std::size_t>(sum);
      const double half = 0.5 * chance[from];
      chance[from] = half;
      chance[from + static_cast<std::size_t>(rank)] += half;
    }
    reached += rank;
  }
  const int nearer = std::min(rising, all - rising);
  const double tail = std::accumulate(chance.begin(), chance.begin() + nearer + 1, 0.0);
  return std::min(1.0, 2.0 * tail);
}

double normal_p(const std::vector<int>& ranks, int rising) {
  double variance = 0.0;
  for (const int rank : ranks) variance += 0.25 * rank * rank;
  const double mean = 0.5 * std::accumulate(ranks.begin(), ranks.end(), 0);
  return 2.0 * normal_share_below(-std::abs(rising - mean) / std::sqrt(variance));
}

}  // namespace

double mean_of(const std::vector<double>& values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

Interval bootstrap_mean_interval(const std::vector<double>& values) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if (values.size() < 2) return {kNone, kNone};
  if (std::all_of(values.begin(), values.end(), [&](double v) { return v == values.front(); }))
    return {values.front(), values.front()};
  const double mean = mean_of(values);
  const std::vector<double> means = resampled_means(values);
  // Of equal ones half are below.
  const auto below = std::lower_bound(means.begin(), means.end(), mean) - means.begin();
  const auto equal = std::upper_bound(means.begin(), means.end(), mean) - means.begin() - below;
  const double bias =
      normal_quantile((static_cast<double>(below) + 0.5 * static_cast<double>(equal)) / kSamples);
  const double a = acceleration(values, mean);
  const auto end = [&](double tail) {
    const double z = bias + normal_quantile(tail);
    return quantile(means, normal_share_below(bias + z / (1.0 - a * z)));
  };
  return {end(kTail), end(1.0 - kTail)};
}

SignedRank signed_rank(const std::vector<double>& differences) {
  std::vector<double> sizes;
  std::vector<bool> rises;
  for (const double difference : differences) {
    if (difference == 0.0) continue;
    sizes.push_back(std::abs(difference));
    rises.push_back(difference > 0.0);
  }
  SignedRank result;
  result.pairs = sizes.size();
  if (sizes.empty()) return result;
  const std::vector<int> ranks = doubled_ranks(sizes);
  int all = 0;
  int rising = 0;
  for (std::size_t i = 0; i < ranks.size(); ++i) {
    all += ranks[i];
    if (rises[i]) rising += ranks[i];
  }
  result.effect = 2.0 * rising / all - 1.0;
  result.p = ranks.size() <= kMaxExact ? exact_p(ranks, rising) : normal_p(ranks, rising);
  return result;
}

std::vector<double> holm(const std::vector<double>& p) {
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&p](std::size_t a, std::size_t b) { return p[a] < p[b]; });
  std::vector<double> adjusted(p.size());
  double highest = 0.0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    highest = std::max(highest, static_cast<double>(p.size() - i) * p[order[i]]);
    adjusted[order[i]] = std::min(1.0, highest);
  }
  return adjusted;
}

std::vector<MeanRank> mean_ranks(const std::vector<std::vector<double>>& rows) {
  if (rows.empty()) return {};
  std::vector<std::vector<double>> columns(rows.front().size());
  for (const std::vector<double>& row : rows) {
    const std::vector<int> ranks = doubled_ranks(row);
    for (std::size_t i = 0; i < columns.size(); ++i) columns[i].push_back(0.5 * ranks[i]);
  }
  std::vector<MeanRank> result;
  result.reserve(columns.size());
  for (const std::vector<double>& ranks : columns)
    result.push_back({mean_of(ranks), bootstrap_mean_interval(ranks)});
  return result;
}

}  // namespace screed
