// The page that `screed monitor` shows of a robot: attitude, odometry, motors, algorithm, link,
// faults or what prevents arming in words, curves of chosen signals. A pure drawing: the same input
// gives the same page.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "firmware/parameters/board_constants.h"
#include "host_sim/ground_station/link/link.h"
#include "host_sim/ground_station/link/robot_history.h"
#include "host_sim/ground_station/link/text_canvas.h"

namespace screed {

struct DashboardInput {
  uint64_t now_us = 0;
  std::string link_name;
  LinkStatus link;
  const FleetView* fleet = nullptr;
  RobotKey robot;                         ///< which one to show
  std::vector<std::string> curves;        ///< "attitude.pitch"
  double window_s = 30.0;                 ///< of the curves
  int battery_cells = 0;                  ///< NiMH, in series; 0: not known, no charge is shown
  const BoardConstants* board = nullptr;  ///< of the robot; null: not known, no slip is shown
  /// Parts of the last line, the most important first: as many are shown as fit.
  std::vector<std::string> footer;
};

/// Fills the page. Values that are old are pale, with their age; when the link is lost all frames
/// are red. Below 80 x 21 there are no frames, but one value a line, the most important first. A
/// line says what was left out.
void draw_dashboard(TextCanvas& page, const DashboardInput& input);

/// Everything that is known, line by line, for a pipe: no page, no width.
std::string plain_report(const DashboardInput& input);

/// Of the values that a message carries: they are more than a second old, or than one and a half
/// of its periods.
bool is_old(const RobotHistory& robot, const MessageInfo& message, uint64_t now_us);

/// "3 s", "5 min", "2 h".
std::string age_text(double age_s);

}  // namespace screed
