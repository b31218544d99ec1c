// Colours and sizes that the parts of the viewer share.
#pragma once

#include "host_sim/render/picture/color_map.h"

namespace screed::viewer {

inline constexpr Color kBackground{0.085, 0.100, 0.118};
inline constexpr Color kBeyond{0.050, 0.060, 0.072};
inline constexpr Color kTrack{0.20, 0.23, 0.26};
inline constexpr Color kPaleInk{0.93, 0.945, 0.955};
inline constexpr Color kFaintInk{0.58, 0.62, 0.66};
inline constexpr Color kAccent{0.98, 0.66, 0.20};
inline constexpr Color kGood{0.38, 0.78, 0.47};
inline constexpr Color kAlarm{0.96, 0.36, 0.33};
inline constexpr Color kCasing{1.0, 1.0, 1.0};
inline constexpr Color kInk{0.10, 0.115, 0.13};
inline constexpr Color kHull{0.90, 0.91, 0.92};
inline constexpr Color kRubber{0.13, 0.14, 0.15};
inline constexpr Color kLug{0.33, 0.35, 0.37};

}  // namespace screed::viewer
