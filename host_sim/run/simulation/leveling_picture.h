// How a run has leveled, in one picture: the ground before and after it in the same colours, and
// the curves of relief and transport over time.
#pragma once

#include <span>
#include <string>

#include "host_sim/leveling/leveling_point.h"
#include "host_sim/physics/terrain/height_field.h"

namespace screed {

/// The text of an SVG file. `title`: of which run. `points`: its leveling curve, the first from
/// before it; throws InputError when there are less than two.
std::string leveling_svg(const std::string& title, const HeightField& before,
                         const HeightField& after, std::span<const LevelingPoint> points);

}  // namespace screed
