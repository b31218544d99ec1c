// Confidence intervals.
#include "host_sim/core/statistics.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "host_sim/core/elementary.h"
#include "host_sim/core/random.h"

namespace screed {

namespace {

constexpr double kNormal95 = 1.959964;

}  // namespace

Interval wilson(int hits, int all) {
  if (all == 0) return {0.0, 1.0};
  const double n = all;
  const double share = hits / n;
  const double z2 = kNormal95 * kNormal95;
  const double middle = (share + z2 / (2.0 * n)) / (1.0 + z2 / n);
  const double half =
      kNormal95 / (1.0 + z2 / n) * std::sqrt(share * (1.0 - share) / n + z2 / (4.0 * n * n));
  return {std::max(0.0, middle - half), std::min(1.0, middle + half)};
}

Interval poisson(int count) {
  const auto end = [](double n, double z) {
    return n <= 0.0 ? 0.0
                    : n * portable::pow(1.0 - 1.0 / (9.0 * n) + z / (3.0 * std::sqrt(n)), 3.0);
  };
  return {end(count, -kNormal95), end(count + 1.0, kNormal95)};
}

Interval median_interval(const std::vector<double>& values) {
  const double half = 0.5 * kNormal95 / std::sqrt(static_cast<double>(values.size()));
  return {quantile(values, std::max(0.0, 0.5 - half)), quantile(values, std::min(1.0, 0.5 + half))};
}

Interval mean_square_interval(double degrees) {
  const double part = 2.0 / (9.0 * degrees);
  const auto end = [part](double z) {
    return portable::pow(1.0 - part + z * std::sqrt(part), 3.0);
  };
  return {end(-kNormal95), end(kNormal95)};
}

namespace {

constexpr int kSamples = 10'000;
constexpr std::uint64_t kSeed = 1;
constexpr double kTail = 0.025;
constexpr std::size_t kMaxExact = 200;
constexpr Interval kNoInterval{std::numeric_limits<double>::quiet_NaN(),
                               std::numeric_limits<double>::quiet_NaN()};

/// A mean that rounding does not carry beyond what it is of: of equal values it is that value.
class MeanBetween {
 public:
  void add(double value) {
    sum_ += value;
    ++count_;
    least_ = std::min(least_, value);
    greatest_ = std::max(greatest_, value);
  }
  /// Of NaN it is NaN, which std::clamp() would not have to keep.
  double value() const {
    return std::min(std::max(sum_ / static_cast<double>(count_), least_), greatest_);
  }

 private:
  double sum_ = 0.0;
  std::size_t count_ = 0;
  double least_ = std::numeric_limits<double>::infinity();
  double greatest_ = -std::numeric_limits<double>::infinity();
};

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

/// Of samples of `count` values with replacement, rising.
std::vector<double> resampled(std::size_t count, const FigureOfPairs& statistic) {
  WorldRandom random(kSeed, "bootstrap");
  std::vector<std::size_t> chosen(count);
  std::vector<double> figures(kSamples);
  for (double& figure : figures) {
    for (std::size_t& one : chosen) one = (random.next() * std::uint64_t{count}) >> 32U;
    figure = statistic(chosen);
  }
  std::sort(figures.begin(), figures.end());
  return figures;
}

/// How the figure's standard error changes with the figure, from leaving out one value each
/// (Efron 1987, the jackknife's estimate).
double acceleration(std::size_t count, const FigureOfPairs& statistic) {
  std::vector<double> without(count);
  std::vector<std::size_t> chosen(count - 1);
  for (std::size_t left_out = 0; left_out < count; ++left_out) {
    for (std::size_t i = 0; i < chosen.size(); ++i) chosen[i] = i < left_out ? i : i + 1;
    without[left_out] = statistic(chosen);
  }
  const double mean = mean_of(without);
  double squares = 0.0;
  double cubes = 0.0;
  for (const double figure : without) {
    const double d = mean - figure;
    squares += d * d;
    cubes += d * d * d;
  }
  return cubes / (6.0 * portable::pow(squares, 1.5));
}

/// BCa, of a figure that is not the same for all samples.
Interval bootstrap_interval(std::size_t count, const FigureOfPairs& statistic) {
  std::vector<std::size_t> all(count);
  std::iota(all.begin(), all.end(), std::size_t{0});
  const double figure = statistic(all);
  const std::vector<double> figures = resampled(count, statistic);
  // Of equal ones half are below.
  const auto below = std::lower_bound(figures.begin(), figures.end(), figure) - figures.begin();
  const auto equal =
      std::upper_bound(figures.begin(), figures.end(), figure) - figures.begin() - below;
  const double bias =
      normal_quantile((static_cast<double>(below) + 0.5 * static_cast<double>(equal)) / kSamples);
  const double a = acceleration(count, statistic);
  const auto end = [&](double tail) {
    const double z = bias + normal_quantile(tail);
    return quantile(figures, normal_share_below(bias + z / (1.0 - a * z)));
  };
  return {end(kTail), end(1.0 - kTail)};
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
  MeanBetween mean;
  for (const double value : values) mean.add(value);
  return mean.value();
}

Interval bootstrap_mean_interval(const std::vector<double>& values) {
  if (values.size() < 2) return kNoInterval;
  if (std::all_of(values.begin(), values.end(), [&](double v) { return v == values.front(); }))
    return {values.front(), values.front()};
  return bootstrap_interval(values.size(), [&values](const std::vector<std::size_t>& chosen) {
    MeanBetween mean;
    for (const std::size_t one : chosen) mean.add(values[one]);
    return mean.value();
  });
}

Interval bootstrap_ratio_interval(const std::vector<double>& over,
                                  const std::vector<double>& under) {
  if (over.size() != under.size()) throw std::logic_error("a ratio is of pairs");
  const Interval divisor = bootstrap_mean_interval(under);
  if (!(divisor.low > 0.0 || divisor.high < 0.0)) return kNoInterval;
  const auto ratio = [&](const std::vector<std::size_t>& chosen) {
    double sum_over = 0.0;
    double sum_under = 0.0;
    for (const std::size_t one : chosen) {
      sum_over += over[one];
      sum_under += under[one];
    }
    return sum_over / sum_under;
  };
  const double all = mean_of(over) / mean_of(under);
  bool same = true;
  for (std::size_t i = 0; i < over.size(); ++i) same = same && over[i] == all * under[i];
  if (same) return {all, all};
  return bootstrap_interval(over.size(), ratio);
}

double kendall_tau(const std::vector<double>& one, const std::vector<double>& other) {
  double agreement = 0.0;
  double ordered = 0.0;  // pairs that the first orders
  double ordered_by_other = 0.0;
  const auto sign = [](double difference) { return (difference > 0.0) - (difference < 0.0); };
  for (std::size_t i = 0; i < one.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      const int a = sign(one[i] - one[k]);
      const int b = sign(other[i] - other[k]);
      agreement += a * b;
      ordered += a * a;
      ordered_by_other += b * b;
    }
  }
  return agreement / std::sqrt(ordered * ordered_by_other);
}

Interval bootstrap_percentiles(std::size_t pairs, const FigureOfPairs& figure) {
  const std::vector<double> figures = resampled(pairs, figure);
  return {quantile(figures, kTail), quantile(figures, 1.0 - kTail)};
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
