// Names of the supervisor's states, of the leveling algorithm's states and of the faults: those of
// the schema (firmware/protocol/screed.dbc).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "firmware/robot/supervisor.h"
#include "schema/values.h"

namespace screed {

/// How many states there are; they are numbered from 0.
inline constexpr std::size_t kLevelingStates = message::kLevelingStateMax + 1U;

/// The name of a state; "unknown" for a number that has none.
const char* state_name(RobotState state);
const char* leveling_state_name(message::LevelingState state);
/// The names of all of them, by number.
std::vector<std::string> leveling_state_names();
/// The names of the set fault bits, or "none".
std::string fault_names(uint16_t faults);

}  // namespace screed
