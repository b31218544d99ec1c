// The page that `screed calibrate` shows: what to do next, what is done, the field as read. A pure
// drawing.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "host_sim/ground_station/calibration/imu_calibration.h"
#include "host_sim/ground_station/link/link.h"
#include "host_sim/ground_station/link/text_canvas.h"

namespace screed {

struct CalibrationPageInput {
  std::string link_name;
  LinkStatus link;
  double silent_s = 0.0;  ///< since the robot was heard last
  const ImuCollector* collector = nullptr;
  std::span<const CurvePoint> field;  ///< s, mG
};

/// Fills the page. A lost link is red. A small page has no blank lines, then no curve, then no
/// positions.
void draw_calibration(TextCanvas& page, const CalibrationPageInput& input);

}  // namespace screed
