// Keeps a robot that has no map on its site: outside a circle around the start it turns and drives
// back. The circle shrinks as the robot knows less where it is, by twice the standard deviation
// (95 % along a line), down to half of its radius.
#pragma once

#include <stdint.h>

#include "firmware/control/kinematics.h"
#include "firmware/estimation/place.h"
#include "firmware/math/units.h"

namespace screed {

class SiteFence {
 public:
  /// radius_mm: of the circle around the start; 0 switches the fence off. speed: on the way back.
  SiteFence(int16_t radius_mm, int16_t speed_mm_per_s)
      : radius_mm_(radius_mm), speed_mm_per_s_(speed_mm_per_s) {}

  /// Looks at the position. Returns true while the robot has to drive back: from the moment it
  /// leaves the circle until it is well inside (three quarters of the radius) again.
  bool update(const Place& place);

  /// The motion towards the point so far east and north of the robot: turns on the spot while it
  /// lies behind, drives as soon as it lies ahead.
  SCREED_OUT_OF_LINE MotionCommand steer(int16_t east_mm, int16_t north_mm, Angle heading) const;

 private:
  int16_t radius_mm_;
  int16_t speed_mm_per_s_;
  bool returning_ = false;
};

}  // namespace screed
