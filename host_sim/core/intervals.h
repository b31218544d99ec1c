// Confidence intervals, two-sided, 95 %, of what was measured in seeded runs.
#pragma once

#include <vector>

namespace screed {

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

}  // namespace screed
