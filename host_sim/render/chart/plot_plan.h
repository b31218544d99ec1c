// What a plot of many signals shows where: which series share a panel, and how long states held.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace screed {

/// What a series is measured in.
struct SeriesKind {
  std::string unit;       ///< "" for states
  bool is_state = false;  ///< discrete values with names, flags
};

struct PlannedPanel {
  std::string unit;
  bool of_states = false;
  std::vector<std::size_t> series;  ///< their numbers, in the order given
};

/// More lines than this cannot be told apart.
inline constexpr std::size_t kMaxPanelSeries = 6;

/// Units in the order in which they appear, each with as few panels as kMaxPanelSeries allows, of
/// about equal size; one panel with all the states comes last, at the time axis.
std::vector<PlannedPanel> plan_panels(std::span<const SeriesKind> series);

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
