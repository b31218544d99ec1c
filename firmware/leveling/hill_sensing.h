// Algorithm 6 of the thesis: above a threshold of the pitch climb straight on, below it walk at
// random. With the parameter climb_turn the climb follows the slope.
#pragma once

#include "firmware/leveling/behaviour.h"

namespace screed {

class HillSensing : public AlgorithmDefaults {
 public:
  explicit HillSensing(const Parameters& /*parameters*/) {}

  MotionCommand tick(const LevelingInput& input, Behaviour& behaviour) {
    return behaviour.uphill(input) ? behaviour.climb(input) : behaviour.walk();
  }
};

}  // namespace screed
