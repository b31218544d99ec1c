// From SI units and radians to those that people read.
#pragma once

#include <numbers>

namespace screed {

inline constexpr double kDegPerRad = 180.0 / std::numbers::pi;
inline constexpr double kMmPerM = 1000.0;
inline constexpr double kLitresPerM3 = 1000.0;

}  // namespace screed
