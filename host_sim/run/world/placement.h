// Where the robots of an experiment start, and the places that they do not get out of ([trap]).
#pragma once

#include <vector>

#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/run/experiment/experiment.h"

namespace screed {

/// A place for each robot, in their order; of a single robot that of [vehicle]. Of a grid the
/// first row is the southern one; on a ring the robots look outwards, turned by [vehicle] h.
/// Throws InputError when random places do not fit on the bed.
std::vector<RobotPlace> robot_places(const Experiment& experiment, const HeightField& terrain);

/// Changes the terrain as the experiment's trap asks. Widths are the Rover 5's. A wall, slope or
/// trench lies all round the start, so that a robot that turns or walks at random meets it too.
/// Heights that pass the field's range are cut.
void set_trap(const Experiment& experiment, HeightField& field);

}  // namespace screed
