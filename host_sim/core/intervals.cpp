// Confidence intervals.
#include "host_sim/core/intervals.h"

#include <algorithm>
#include <cmath>

#include "host_sim/core/elementary.h"
#include "host_sim/core/quantile.h"

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

}  // namespace screed
