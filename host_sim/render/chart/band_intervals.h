// States over time as intervals: how long a value that is known at single moments has held.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace screed {

/// A value that was seen at a moment.
struct StatePoint {
  double time;
  std::int64_t value;
};

struct BandInterval {
  double begin;
  double end;
  std::int64_t value;
  bool operator==(const BandInterval&) const = default;
};

/// One interval a value, in order; `points` are sorted by time. A value holds until another is
/// seen. It also ends `hold` after the last point, and after a point that the next one follows only
/// after more than `longest_gap`: what was between them is not known. No interval goes beyond
/// `data_end`, up to which anything is known; no point lies after it.
std::vector<BandInterval> band_intervals(std::span<const StatePoint> points, double hold,
                                         double longest_gap, double data_end);

}  // namespace screed
