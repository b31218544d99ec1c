// The soil of a run as a session keeps it.
#pragma once

#include <vector>

#include "host_sim/physics/soil/soil_parameters.h"
#include "host_sim/run/session/session_info.h"

namespace screed {

/// The soil as it is used: the preset with what the experiment changed.
std::vector<SoilAttribute> attributes_of(const SoilParameters& soil);

}  // namespace screed
