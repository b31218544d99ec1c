#include "host_sim/physics/particles/bed_kernels.h"

namespace screed {

const BedFunctions& bed_functions([[maybe_unused]] InstructionSet set) {
#ifdef __x86_64__
  if (set == InstructionSet::kAvx512) return kAvx512BedFunctions;
  if (set == InstructionSet::kAvx2) return kAvx2BedFunctions;
#endif
  return kScalarBedFunctions;
}

}  // namespace screed
