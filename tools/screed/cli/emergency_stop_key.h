// The key that stops a robot at once, the same in every program that has keys: the largest one.
#pragma once

namespace screed {

inline constexpr int kEmergencyStopKey = ' ';
inline constexpr const char* kEmergencyStopKeyName = "SPACE";

}  // namespace screed
