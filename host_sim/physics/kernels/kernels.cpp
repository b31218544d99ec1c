// Which kernels a processor can run.
#include "host_sim/physics/kernels/kernels.h"

#include "host_sim/physics/kernels/kernel_sets.h"

namespace screed {

const Kernels& kernels_for([[maybe_unused]] InstructionSet set) {
#ifdef __x86_64__
  if (set == InstructionSet::kAvx512) return avx512_kernels();
  if (set == InstructionSet::kAvx2) return avx2_kernels();
#endif
  return baseline_kernels();
}

const Kernels& best_kernels() {
  static const Kernels& best = kernels_for(instruction_sets().back());
  return best;
}

}  // namespace screed
