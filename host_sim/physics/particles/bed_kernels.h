// Which vector instructions compute a bed of particles.
#pragma once

#include <cstdint>
#include <vector>

#include "host_sim/physics/particles/bed_kernel.h"

namespace screed {

/// All give the same bits.
enum class BedKernel : std::uint8_t { kScalar, kAvx2, kAvx512 };

const char* bed_kernel_name(BedKernel kernel);
/// The kernels that this processor has, slowest first.
std::vector<BedKernel> bed_kernels();
/// Throws InputError when this processor does not have the kernel.
const BedFunctions& bed_functions(BedKernel kernel);

}  // namespace screed
