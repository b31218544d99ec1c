// Algorithm 6 of the thesis: above a threshold of the pitch climb straight on, below it walk at
// random.
#pragma once

#include "firmware/leveling/behaviour.h"

namespace screed {

class HillSensing : public AlgorithmDefaults {
 public:
  explicit HillSensing(const Parameters& /*parameters*/) {}

  MotionCommand tick(const LevelingInput& input, Behaviour& behaviour) {
    return behaviour.uphill(input.pitch) ? behaviour.climb() : behaviour.walk();
  }
};

}  // namespace screed
