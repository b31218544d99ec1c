// Standard gravity.
#pragma once

namespace screed {

inline constexpr double kGravity_m_per_s2 = 9.80665;

}  // namespace screed
