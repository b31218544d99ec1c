#include "host_sim/physics/particles/bed_kernels.h"

namespace screed {

const BedFunctions& bed_functions(InstructionSet set) {
  switch (set) {
    case InstructionSet::kAvx512:
      return kAvx512BedFunctions;
    case InstructionSet::kAvx2:
      return kAvx2BedFunctions;
    case InstructionSet::kBaseline:
      break;
  }
  return kScalarBedFunctions;
}

}  // namespace screed
