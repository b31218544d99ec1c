// Quantiles of a sample.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace screed {

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

}  // namespace screed
