// Extremes of buckets.
#include "host_sim/run/report/curve_sampler.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace screed {

CurveSampling::CurveSampling(std::uint64_t tick_count)
    : ticks(tick_count),
      bucket_ticks(
          tick_count <= kMaxSamples ? 1 : (tick_count + kMaxSamples / 2 - 1) / (kMaxSamples / 2)) {}

std::vector<std::uint64_t> CurveSampling::rows() const {
  std::vector<std::uint64_t> rows;
  for (std::uint64_t first = 0; first < ticks; first += bucket_ticks) {
    rows.push_back(first);
    if (bucket_ticks == 1) continue;
    // A last bucket of one tick has its middle at its only row.
    const std::uint64_t count = std::min(bucket_ticks, ticks - first);
    rows.push_back(first + count / 2);
  }
  return rows;
}

void CurveSampler::add(double value) {
  if (std::isfinite(value)) {
    if (!any_) {
      low_ = high_ = value;
      high_first_ = false;
    } else if (value > high_) {
      high_ = value;
      high_first_ = false;
    } else if (value < low_) {
      low_ = value;
      high_first_ = true;
    }
    any_ = true;
  }
  if (++in_bucket_ == sampling_.bucket_ticks) finish_bucket();
}

void CurveSampler::finish_bucket() {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  const float low = any_ ? static_cast<float>(low_) : kNone;
  const float high = any_ ? static_cast<float>(high_) : kNone;
  samples_.push_back(high_first_ ? high : low);
  if (sampling_.bucket_ticks > 1) samples_.push_back(high_first_ ? low : high);
  in_bucket_ = 0;
  any_ = false;
}

std::vector<float> CurveSampler::samples() {
  if (in_bucket_ > 0) finish_bucket();
  return samples_;
}

}  // namespace screed
