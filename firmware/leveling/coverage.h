// Coverage in parallel lines (boustrophedon) by dead reckoning.
//
// The lines run east and west over a square round the start, a spacing apart. They begin at the
// start's own, go north to the square's edge, then south to the other, and so on without end. The
// robot steers for a point on the line that lies a fixed distance ahead of it, so an error across
// the line dies away; every second line is driven backwards. The site's circle has to hold the
// square's corners: the half side is at most 0.7 of its radius. Where the fence turns the robot
// back all the same, or it got stuck and out again, it goes on with the next line.
#pragma once

#include "firmware/leveling/behaviour.h"

namespace screed {

class Coverage : public AlgorithmDefaults {
 public:
  explicit Coverage(const Parameters& parameters)
      : half_side_mm_(parameters.coverage_half_side()), step_mm_(parameters.coverage_spacing()) {}

  SCREED_OUT_OF_LINE MotionCommand tick(const LevelingInput& input, Behaviour& behaviour);

 private:
  void next_line();

  int16_t half_side_mm_;
  int16_t step_mm_;      ///< to the next line, northward positive
  int16_t line_mm_ = 0;  ///< north of the start
  bool west_ = false;
};

}  // namespace screed
