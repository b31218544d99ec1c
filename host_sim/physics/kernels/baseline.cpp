// The kernels for every processor.
#include <math.h>

#include "host_sim/core/elementary.h"
#include "host_sim/physics/kernels/kernel_sets.h"
#include "host_sim/physics/kernels/kernels.h"

namespace screed {
namespace {

constexpr InstructionSet kInstructions = InstructionSet::kBaseline;

#include "host_sim/core/lanes/baseline.inc"
#include "host_sim/core/lanes/lanes.inc"
#include "host_sim/physics/kernels/all.inc"

}  // namespace

const Kernels& baseline_kernels() {
  return kKernels;
}

}  // namespace screed
