// Where the robots of an experiment start.
#pragma once

#include <vector>

#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/experiment/sections/robots_section.h"

namespace screed {

/// A place for each robot, in their order; of a single robot that of [vehicle]. Of a grid the
/// first row is the southern one; on a ring the robots look outwards, turned by [vehicle] h.
/// Throws InputError when random places do not fit on the bed.
std::vector<RobotPlace> robot_places(const Experiment& experiment, const HeightField& terrain);

}  // namespace screed
