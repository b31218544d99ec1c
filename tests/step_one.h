// A physics step of a world of one robot.
#pragma once

#include "host_sim/physics/world/environment.h"

namespace screed::testing {

inline void step_one(Environment& world, const DutyRatio& duty_ratio) {
  world.step({&duty_ratio, 1});
}

}  // namespace screed::testing
