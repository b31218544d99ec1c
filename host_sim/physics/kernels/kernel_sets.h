// The kernels as compiled for each set of instructions.
#pragma once

#include "host_sim/physics/kernels/kernels.h"

namespace screed {

const Kernels& baseline_kernels();
const Kernels& avx2_kernels();
const Kernels& avx512_kernels();

}  // namespace screed
