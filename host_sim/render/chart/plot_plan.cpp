// Panels and intervals.
#include "host_sim/render/chart/plot_plan.h"

#include <algorithm>

namespace screed {

std::vector<PlannedPanel> plan_panels(std::span<const SeriesKind> series) {
  std::vector<PlannedPanel> units;
  PlannedPanel states{"", true, {}};
  for (std::size_t i = 0; i < series.size(); ++i) {
    if (series[i].is_state) {
      states.series.push_back(i);
      continue;
    }
    auto panel = std::find_if(units.begin(), units.end(),
                              [&](const PlannedPanel& it) { return it.unit == series[i].unit; });
    if (panel == units.end()) panel = units.insert(units.end(), {series[i].unit, false, {}});
    panel->series.push_back(i);
  }
  std::vector<PlannedPanel> panels;
  for (const PlannedPanel& unit : units) {
    const std::size_t count = unit.series.size();
    const std::size_t parts = (count + kMaxPanelSeries - 1) / kMaxPanelSeries;
    for (std::size_t part = 0; part < parts; ++part) {
      const auto begin = unit.series.begin() + static_cast<long>(part * count / parts);
      const auto end = unit.series.begin() + static_cast<long>((part + 1) * count / parts);
      panels.push_back({unit.unit, false, {begin, end}});
    }
  }
  if (!states.series.empty()) panels.push_back(std::move(states));
  return panels;
}

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
