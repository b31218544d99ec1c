// What the dashboard says of a robot, before it is laid out: values in words, with their age, in
// groups, each with its importance for pages that have no room for all.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/ground_station/link/dashboard.h"

namespace screed {

/// Of the row with the slip of both tracks, which no message carries.
constexpr const char* kSlipLabel = "slip l, r";

struct DashboardBar {
  double value;  ///< -1..1
  bool warn;
};

struct DashboardRow {
  int importance;     ///< the smaller, the more important
  std::string label;  ///< empty: the value takes the whole width
  std::string value;
  CellStyle style = CellStyle::kNormal;
  std::optional<DashboardBar> bar = {};
};

struct DashboardGroup {
  std::string title;
  std::vector<DashboardRow> rows;
};

/// A value as printf writes it.
std::string number(const char* pattern, double value);

/// Nothing has come from the robot for a second, or the link is down: everything shown is history.
bool link_lost(const DashboardInput& input, const RobotHistory& robot);

/// Of the values that a message carries: they are more than a second old, or than one and a half
/// of its periods.
bool is_old(const RobotHistory& robot, const MessageInfo& message, uint64_t now_us);

/// "3 s", "5 min", "2 h".
std::string age_text(double age_s);

/// The groups, in the order of the page.
std::vector<DashboardGroup> dashboard_groups(const DashboardInput& input,
                                             const RobotHistory& robot);

/// "3 damaged, 0 unknown".
std::string refused_text(const DashboardInput& input);

}  // namespace screed
