// How far a rigid body sinks and tilts in one step, together with the soil's springs below it.
#pragma once

#include <span>

#include "host_sim/physics/kernels/kernels.h"
#include "host_sim/physics/terrain/footprint_contact.h"

namespace screed {

/// End-of-step implicit: the body moves by q (up, roll, pitch) so that M (q - q_free) / dt^2 is the
/// springs' force after q. q_free is where it would go without soil: its speed, and what else
/// pushes it as the last step showed it. The energy is convex, so Newton's method with a line
/// search finds it. Without it unloading, some hundred times stiffer than loading, would chatter or
/// would have to be softened; footprint by footprint, a robot's other wheels would be felt one step
/// late. Fills in each spring's `sinking`; leaves 0 where the motion is imposed. Remembers for the
/// next step. Returns how often the springs' forces were evaluated beyond the first time: one a
/// Newton step and one a shortening of it; 0 where the motion is imposed.
int solve_sinking(const PressingBody& body, double dt, std::span<SpringBlock> springs,
                  BodyMemory& memory, const Kernels& kernels = best_kernels());

}  // namespace screed
