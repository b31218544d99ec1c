// The legs of the random walk of Algorithm 6: of random speed, turn rate and length.
//
// The thesis draws anew at every step; at 100 steps a second that averages to a straight crawl, so
// a draw is held for a random time.
#pragma once

#include <stdint.h>

#include "firmware/control/kinematics.h"
#include "firmware/math/random.h"
#include "firmware/parameters/kept.h"
#include "firmware/parameters/parameters.h"

namespace screed {

class WalkLegs {
 public:
  explicit WalkLegs(const Parameters& parameters);
  /// Live parameters (parameters.h), at any time.
  void take(const Parameters& parameters) { keep(parameters_, parameters); }

  /// Draws a new leg at the next tick.
  void restart() { ticks_left_ = 0; }

  /// One tick: the motion of the current leg.
  MotionCommand tick();

 private:
  Random random_;
  Kept<Parameters> parameters_;
  uint16_t ticks_left_ = 0;
  MotionCommand leg_ = {0, 0};
};

}  // namespace screed
