// The kernels with AVX2.
#include <immintrin.h>
#include <math.h>

#include "host_sim/core/elementary.h"
#include "host_sim/physics/kernels/kernel_sets.h"
#include "host_sim/physics/kernels/kernels.h"

namespace screed {
namespace {

constexpr InstructionSet kInstructions = InstructionSet::kAvx2;

#include "host_sim/core/lanes/avx2.inc"
#include "host_sim/core/lanes/lanes.inc"
#include "host_sim/physics/kernels/all.inc"

}  // namespace

const Kernels& avx2_kernels() {
  return kKernels;
}

}  // namespace screed
