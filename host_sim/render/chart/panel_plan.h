// Which series of a plot share a panel: one axis a unit, states apart, never too many lines.
#pragma once

#include <cstddef>
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

}  // namespace screed
