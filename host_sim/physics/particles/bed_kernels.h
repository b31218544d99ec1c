// Which vector instructions compute a bed of particles.
#pragma once

#include "host_sim/core/lanes/instruction_set.h"
#include "host_sim/physics/particles/bed_kernel.h"

namespace screed {

/// Those for a set of instructions that this processor has.
const BedFunctions& bed_functions(InstructionSet set);

}  // namespace screed
