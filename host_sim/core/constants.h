// Numbers that every world needs.
#pragma once

#include <numbers>

#include "hal/sample.h"

namespace screed {

/// How long a control tick lasts, on the robot and in every world.
inline constexpr double kTick_s = 1.0 / kTickRate_hz;
inline constexpr double kSecondsPerHour = 3600.0;
/// In radians.
inline constexpr double kDegree = std::numbers::pi / 180.0;

}  // namespace screed
