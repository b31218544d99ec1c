// The kernels with AVX-512.
#include <immintrin.h>
#include <math.h>

#include "host_sim/core/elementary.h"
#include "host_sim/physics/kernels/kernel_sets.h"
#include "host_sim/physics/kernels/kernels.h"

namespace screed {
namespace {

constexpr InstructionSet kInstructions = InstructionSet::kAvx512;

#include "host_sim/core/lanes/avx512.inc"
#include "host_sim/core/lanes/lanes.inc"
#include "host_sim/physics/kernels/all.inc"

}  // namespace

const Kernels& avx512_kernels() {
  return kKernels;
}

}  // namespace screed
