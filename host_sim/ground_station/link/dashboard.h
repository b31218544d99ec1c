// The page that `screed monitor` shows of a robot: attitude, odometry, motors, algorithm, link,
// faults in words, curves of chosen signals. A pure drawing: the same input gives the same page.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host_sim/ground_station/link/link.h"
#include "host_sim/ground_station/link/robot_view.h"
#include "host_sim/ground_station/link/text_canvas.h"

namespace screed {

struct DashboardInput {
  uint64_t now_us = 0;
  std::string link_name;
  LinkStatus link;
  const FleetView* fleet = nullptr;
  RobotKey robot;                   ///< which one to show
  std::vector<std::string> curves;  ///< "attitude.pitch"
  double window_s = 30.0;           ///< of the curves
  std::string footer;               ///< keys, or the log's name
};

/// Fills the page; what has no room is left out, from the bottom.
void draw_dashboard(TextCanvas& page, const DashboardInput& input);

/// Everything that is known, line by line, for a pipe: no page, no width.
std::string plain_report(const DashboardInput& input);

}  // namespace screed
