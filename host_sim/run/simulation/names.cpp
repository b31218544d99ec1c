// The tables of names.
#include "host_sim/run/simulation/names.h"

#include <cstddef>
#include <iterator>

namespace screed {
namespace {

constexpr const char* kStateNames[kRobotStates] = {"disarmed", "armed", "running", "stopped",
                                                   "fault"};
constexpr const char* kLevelingStateNames[kLevelingStates] = {
    "idle", "walk", "climb", "spin", "return", "drive", "training_drive", "done"};
constexpr const char* kFaultNames[] = {"tilt",
                                       "IMU silent",
                                       "gyro frozen",
                                       "left track stalled",
                                       "right track stalled",
                                       "battery low",
                                       "parameters",
                                       "emergency stop",
                                       "LSM303D fails",
                                       "L3GD20H fails",
                                       "LPS25H fails",
                                       "left encoder",
                                       "right encoder",
                                       "stuck"};

}  // namespace

const char* state_name(RobotState state) {
  const auto index = static_cast<size_t>(state);
  return index < kRobotStates ? kStateNames[index] : "unknown";
}

const char* leveling_state_name(LevelingState state) {
  const auto index = static_cast<size_t>(state);
  return index < kLevelingStates ? kLevelingStateNames[index] : "unknown";
}

std::string fault_names(uint16_t faults) {
  std::string names;
  for (size_t bit = 0; bit < std::size(kFaultNames); ++bit) {
    if ((faults >> bit & 1U) != 0)
      names += (names.empty() ? "" : ", ") + std::string(kFaultNames[bit]);
  }
  return names.empty() ? "none" : names;
}

}  // namespace screed
