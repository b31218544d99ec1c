// The walls of the site: a rectangle whose sides run east and north about the origin, in which a
// robot that touches a wall learns where it is.
#pragma once

#include <stdint.h>

#include "firmware/estimation/position_estimate.h"
#include "firmware/parameters/board_constants.h"
#include "firmware/parameters/parameters.h"

namespace screed {

class SiteWalls {
 public:
  SiteWalls(const BoardConstants& board, const Parameters& parameters)
      : half_mm_{parameters.site_x, parameters.site_y},
        reach_mm_(static_cast<int16_t>(board.hull_reach_mm)) {}

  /// The robot has driven against something; `travel`: where to, counter-clockwise from east. It is
  /// the wall that it travels to most directly. False where there is none, or it cannot be there:
  /// then nothing is changed.
  bool touch(Angle travel, PositionEstimate& position) const;

  static constexpr uint8_t kSigma_mm = 40;  ///< of a place so found: hull, angle, piles

 private:
  int16_t half_mm_[2];  ///< 0: no walls
  int16_t reach_mm_;    ///< from the robot's middle to the wall that it touches
};

}  // namespace screed
