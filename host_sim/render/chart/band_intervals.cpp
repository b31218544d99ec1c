#include "host_sim/render/chart/band_intervals.h"

#include <algorithm>

namespace screed {

std::vector<BandInterval> band_intervals(std::span<const StatePoint> points, double hold,
                                         double longest_gap, double data_end) {
  std::vector<BandInterval> intervals;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const StatePoint& point = points[i];
    const bool follows = i > 0 && point.time - points[i - 1].time <= longest_gap;
    if (!follows || intervals.back().value != point.value) {
      intervals.push_back({point.time, point.time, point.value});
    }
    const bool goes_on = i + 1 < points.size() && points[i + 1].time - point.time <= longest_gap;
    intervals.back().end =
        goes_on ? points[i + 1].time : std::min(point.time + hold, std::max(point.time, data_end));
  }
  return intervals;
}

}  // namespace screed
