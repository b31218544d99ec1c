// No algorithm: the ground station commands the motion, inside the site and outside.
#pragma once

#include "firmware/leveling/behaviour.h"

namespace screed {

class Drive : public AlgorithmDefaults {
 public:
  static constexpr bool kKeepsToSite = false;

  explicit Drive(const Parameters& /*parameters*/) {}

  MotionCommand tick(const LevelingInput& input, Behaviour& behaviour) {
    return behaviour.enter_or_stay(LevelingState::kDrive, input.drive);
  }
};

}  // namespace screed
