// Keeps a robot that has no map on its site: outside a circle around the start it turns and drives
// back. The circle shrinks as the robot knows less where it is, by the standard deviation of the
// worse axis, down to half of its radius.
#pragma once

#include <stdint.h>

#include "firmware/control/kinematics.h"
#include "firmware/estimation/place.h"
#include "firmware/math/units.h"
#include "firmware/parameters/kept.h"
#include "firmware/parameters/parameters.h"

namespace screed {

class SiteFence {
 public:
  /// site_radius: of the circle around the start; 0 switches the fence off. walk_speed_max: on the
  /// way back.
  explicit SiteFence(const Parameters& parameters) : parameters_(parameters) {}
  /// Live parameters (parameters.h), at any time.
  void take(const Parameters& parameters) { keep(parameters_, parameters); }

  /// Looks at the position. Returns whether the robot is outside the circle.
  bool update(const Place& place);
  /// It was at the last update.
  bool outside() const { return outside_; }

  /// The motion towards the point so far east and north of the robot, backwards where it lies
  /// behind: on loose ground turning digs in. Turns on the spot while it lies aside, drives as soon
  /// as it lies within 45 degrees.
  SCREED_OUT_OF_LINE MotionCommand steer(int16_t east_mm, int16_t north_mm, Angle heading) const;

 private:
  Kept<Parameters> parameters_;
  bool outside_ = false;
};

}  // namespace screed
