// A surface as a robot feels it: what a Gaussian low-pass of half its width leaves is what it
// drives up and down, what the low-pass takes away is what its tracks roll over.
#pragma once

#include "host_sim/physics/terrain/height_field.h"

namespace screed {

/// Standard deviation of the low-pass that parts relief from roughness: half the robot's width, m.
inline constexpr double kRobotScale_m = 0.05;

/// Root mean squares over the nodes of the heights above the mean plane (low_pass.h), and of the
/// low-passed surface with its plane the heights about their mean and the slopes.
struct RobotScaleFigures {
  double level_deviation_m =
      0.0;                   ///< U: of what a low-pass of kRobotScale_m leaves, with its plane
  double relief_m = 0.0;     ///< R: of what a low-pass of kRobotScale_m leaves
  double roughness_m = 0.0;  ///< Q: of what it takes away: ruts, ridges, single stones
  double flatness = 0.0;     ///< F: share of cells whose low-passed slope is within the limit, 0..1
};

/// flat_deg: the limit, 0..89. A slope that exceeds it by no more than gradient_rounding() counts
/// as within, as in flatness(). Throws InputError outside of the range.
RobotScaleFigures robot_scale_figures(const HeightField& field, double flat_deg);

}  // namespace screed
