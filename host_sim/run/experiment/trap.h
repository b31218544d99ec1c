// Places that robots do not get out of, cut into the terrain of an experiment ([trap]).
#pragma once

#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/run/experiment/experiment.h"

namespace screed {

/// Changes the terrain as the experiment's trap asks. Widths are the Rover 5's. A wall, slope or
/// trench lies all round the start, so that a robot that turns or walks at random meets it too.
/// Heights that pass the field's range are cut.
void set_trap(const Experiment& experiment, HeightField& field);

}  // namespace screed
