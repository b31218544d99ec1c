// Names of the supervisor's states, of the leveling algorithm's states and of the faults.
#pragma once

#include <cstdint>
#include <string>

#include "firmware/leveling/leveling.h"
#include "firmware/robot/supervisor.h"

namespace screed {

/// Names of the supervisor's states, of the algorithm's states and of the set fault bits ("none").
const char* state_name(RobotState state);
const char* leveling_state_name(LevelingState state);
std::string fault_names(uint16_t faults);

}  // namespace screed
