// Constants of nature and of units.
#pragma once

#include <numbers>

#include "hal/sample.h"

namespace screed {

// Standard gravity.

inline constexpr double kGravity_m_per_s2 = 9.80665;

// From SI units and radians to those that people read.

inline constexpr double kDegPerRad = 180.0 / std::numbers::pi;
inline constexpr double kMmPerM = 1000.0;
inline constexpr double kLitresPerM3 = 1000.0;

// Numbers that every world needs.

/// How long a control tick lasts, on the robot and in every world.
inline constexpr double kTick_s = 1.0 / kTickRate_hz;
inline constexpr double kSecondsPerHour = 3600.0;
/// In radians.
inline constexpr double kDegree = std::numbers::pi / 180.0;

}  // namespace screed
