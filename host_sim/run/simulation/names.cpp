// Names of states and faults, looked up in the schema.
#include "host_sim/run/simulation/names.h"

#include "host_sim/ground_station/telemetry/schema.h"

namespace screed {
namespace {

const char* name_of(const SignalInfo& signal, int64_t value) {
  const char* const name = signal.value_name(value);
  return name == nullptr ? "unknown" : name;
}

}  // namespace

const char* state_name(RobotState state) {
  static const SignalInfo& signal = *find_signal("heartbeat.state").signal;
  return name_of(signal, static_cast<int64_t>(state));
}

const char* leveling_state_name(message::LevelingState state) {
  static const SignalInfo& signal = *find_signal("leveling.state").signal;
  return name_of(signal, static_cast<int64_t>(state));
}

std::vector<std::string> leveling_state_names() {
  std::vector<std::string> names;
  names.reserve(kLevelingStates);
  for (size_t state = 0; state < kLevelingStates; ++state) {
    names.emplace_back(leveling_state_name(static_cast<message::LevelingState>(state)));
  }
  return names;
}

std::string fault_names(uint16_t faults) {
  const std::string names = flag_names("heartbeat", "faults", faults);
  return names.empty() ? "none" : names;
}

}  // namespace screed
