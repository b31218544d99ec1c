// Quantiles, confidence intervals, and comparisons of paired runs.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <limits>
#include <vector>

namespace screed {

// Quantiles of a sample.

/// The value below which that share (0..1) of the values lies, by linear interpolation; NaN without
/// any.
inline double quantile(std::vector<double> values, double share) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const double at = share * static_cast<double>(values.size() - 1);
  const auto low = static_cast<std::size_t>(at);
  const std::size_t high = std::min(low + 1, values.size() - 1);
  return values[low] + (at - static_cast<double>(low)) * (values[high] - values[low]);
}

// Confidence intervals, two-sided, 95 %, of what was measured in seeded runs.

struct Interval {
  double low;
  double high;
};

/// Of a share of which `hits` of `all` were seen (Wilson, 1927); 0 to 1 of nothing.
Interval wilson(int hits, int all);

/// Of the mean number of events of which `count` were seen (Garwood, 1936, by the approximation of
/// Wilson and Hilferty).
Interval poisson(int count);

/// Of the median, by order statistics: the binomial distribution of its rank, as a normal one. NaN
/// without values.
Interval median_interval(const std::vector<double>& values);

/// Between which the mean of so many squares of standard normal numbers lies: the chi-squared
/// distribution over its degrees of freedom (Wilson and Hilferty, 1931).
Interval mean_square_interval(double degrees);

// Statistics of runs that are paired by their seeds: intervals of means, tests of differences,
// ranks.

/// NaN without values.
double mean_of(const std::vector<double>& values);

/// Of the mean, 95 %, by the bootstrap, bias-corrected and accelerated (BCa; Efron 1987), with
/// 10,000 samples of a fixed seed: the same values give the same interval. Both ends the value
/// where all are equal; NaN of fewer than two.
Interval bootstrap_mean_interval(const std::vector<double>& values);

/// Of the mean of `over` by that of `under`, likewise, over pairs: both are of the same length.
/// NaN unless the mean of `under` differs from 0 by its own interval.
Interval bootstrap_ratio_interval(const std::vector<double>& over,
                                  const std::vector<double>& under);

/// Kendall's rank correlation tau-b, -1..1: 1, both order all alike. NaN where one of them orders
/// nothing. Both are of the same length.
double kendall_tau(const std::vector<double>& one, const std::vector<double>& other);

/// A figure of pairs that may be chosen several times, by their numbers.
using FigureOfPairs = std::function<double(const std::vector<std::size_t>& chosen)>;
/// Its 95 % interval by the bootstrap, percentiles, with 10,000 samples of a fixed seed: for
/// figures that take few values, where there is nothing to accelerate.
Interval bootstrap_percentiles(std::size_t pairs, const FigureOfPairs& figure);

struct SignedRank {
  double p = 1.0;       ///< two-sided
  double effect = 0.0;  ///< matched-pairs rank-biserial correlation, -1..1: 1, all differences rise
  std::size_t pairs = 0;  ///< differences that are not 0
};

/// Wilcoxon's signed-rank test of the differences of pairs, those of 0 left out, equal ones with
/// their mean rank. Exact, ties included, for up to 200 pairs; by the normal distribution beyond.
SignedRank signed_rank(const std::vector<double>& differences);

/// The same p adjusted so that the chance of any false one among all is that of one (Holm 1979), in
/// their order; at most 1.
std::vector<double> holm(const std::vector<double>& p);

/// Mean rank of each column over the rows, 1 the lowest value, equal ones with their mean rank,
/// with the interval of bootstrap_mean_interval() over the rows. Rows are of the same length.
struct MeanRank {
  double mean = 0.0;
  Interval interval{};
};
std::vector<MeanRank> mean_ranks(const std::vector<std::vector<double>>& rows);

}  // namespace screed
