// Confidence intervals of what was counted in seeded drives.
#pragma once

namespace screed::nn {

/// Two-sided 95 % interval.
struct Interval {
  double low;
  double high;
};
/// Of a share of which `hits` of `all` were seen (Wilson, 1927); 0 to 1 of nothing.
Interval wilson(int hits, int all);
/// Of the mean number of events of which `count` were seen (Garwood, 1936, by the approximation of
/// Wilson and Hilferty).
Interval poisson(int count);

}  // namespace screed::nn
