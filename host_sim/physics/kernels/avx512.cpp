// The kernels with AVX-512.
#include <immintrin.h>
#include <math.h>

#include "host_sim/physics/kernels/kernel_sets.h"
#include "host_sim/physics/kernels/kernels.h"

namespace screed {
namespace {

#include "host_sim/core/lanes/avx512.inc"
#include "host_sim/core/lanes/lanes.inc"
#include "host_sim/physics/kernels/track_surface.inc"
#include "host_sim/physics/kernels/candidates.inc"
#include "host_sim/physics/kernels/cell_stress.inc"
#include "host_sim/physics/kernels/springs.inc"
#include "host_sim/physics/kernels/shear_places.inc"
#include "host_sim/physics/kernels/reaction.inc"

}  // namespace

const Kernels& avx512_kernels() {
  static constexpr Kernels kKernels = {
      InstructionSet::kAvx512, track_surface, any_above, classify, place_points, divide_cells,
      entry_angle, sample_cells, stress_lift, spring_sums, spring_sinking, advance_shear, look_up_shear, react};
  return kKernels;
}

}  // namespace screed
