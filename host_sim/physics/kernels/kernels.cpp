// Which kernels a processor can run.
#include "host_sim/physics/kernels/kernels.h"

#include "host_sim/physics/kernels/kernel_sets.h"

namespace screed {

const Kernels& kernels_for(InstructionSet set) {
  switch (set) {
    case InstructionSet::kAvx512:
      return avx512_kernels();
    case InstructionSet::kAvx2:
      return avx2_kernels();
    case InstructionSet::kBaseline:
      break;
  }
  return baseline_kernels();
}

const Kernels& best_kernels() {
  static const Kernels& best = kernels_for(instruction_sets().back());
  return best;
}

}  // namespace screed
