// How far a body sinks: the way that a footprint came, and the balance of load and springs.
#pragma once

#include <Eigen/Core>
#include <span>

#include "host_sim/physics/kernels/kernels.h"
#include "host_sim/physics/terrain/footprint.h"
#include "host_sim/physics/terrain/footprint_contact.h"

namespace screed {

// What a soil bed remembers of the way that a footprint came: a straight path in the footprint's
// own axes. Soil below it has been pressed as deep as the footprint was on its path.

/// Of the height of a path.
inline constexpr double kPathError_m = 2e-4;

/// Extends a footprint's path by a step: `displacement`, world frame, m, and `turned` about its own
/// axes, rad. With s and dz the displacement's parts along local x and z, |dz| <= |s|, and L half
/// the length of a track, wheel or box:
///   travel   += s                              as far as the past path tells anything, see below
///   gradient += |s| / L (dz / s - gradient)    a mean that favours the recent path; 0 if |s| >= L
///   bend     += pitched - |s| / L bend         how much it has pitched against its recent path
/// Without follow_slopes the gradient is that of a level path.
///
/// The past tells where the surface has been no further back than the footprint is long, 2 L, and
/// in a turn, as radius R of the path, no further than where the straight path leaves the curved
/// one by half the width w: s^2 / (2 R) = w / 2. A footprint that has pitched, as over a crest,
/// lies in other axes than those that it came in: the past tells no further back than where they
/// part by kPathError_m. A wheel is round however it pitches.
///
/// What the footprint sinks by beyond |s|, standing or slipping on the spot, brings it down to
/// where it had been lower on its path: the far end of the path comes up by that until it is level
/// with the footprint. Without this a robot that digs itself in on the spot would never touch the
/// soil below a path that once rose.
void extend_path(const Footprint& footprint, const Eigen::Vector3d& displacement,
                 const Eigen::Vector3d& turned, bool follow_slopes, PathHistory& path);

// How far a rigid body sinks and tilts in one step, together with the soil's springs below it.

/// End-of-step implicit: the body moves by q (up, roll, pitch) so that M (q - q_free) / dt^2 is the
/// springs' force after q. q_free is where it would go without soil: its speed, and what else
/// pushes it as the last step showed it. The energy is convex, so Newton's method with a line
/// search finds it. Without it unloading, some hundred times stiffer than loading, would chatter or
/// would have to be softened; footprint by footprint, a robot's other wheels would be felt one step
/// late. Fills in each spring's `sinking`; leaves 0 where the motion is imposed. Remembers for the
/// next step. Returns how often the springs' forces were evaluated beyond the first time: one a
/// Newton step and one a shortening of it; 0 where the motion is imposed.
/// `damped`: springs have dampers.
int solve_sinking(const PressingBody& body, double dt, std::span<SpringBlock> springs, bool damped,
                  BodyMemory& memory, const Kernels& kernels = best_kernels());

}  // namespace screed
