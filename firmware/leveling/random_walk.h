// The random walk of Algorithm 6 alone, whatever the pitch: what a leveling algorithm has to beat.
#pragma once

#include "firmware/leveling/behaviour.h"

namespace screed {

class RandomWalk : public AlgorithmDefaults {
 public:
  explicit RandomWalk(const Parameters& /*parameters*/) {}

  MotionCommand tick(const LevelingInput& /*input*/, Behaviour& behaviour) {
    return behaviour.walk();
  }
};

}  // namespace screed
