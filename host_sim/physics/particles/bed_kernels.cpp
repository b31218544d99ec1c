#include "host_sim/physics/particles/bed_kernels.h"

#include <algorithm>
#include <string>

#include "host_sim/core/errors.h"

namespace screed {

const char* bed_kernel_name(BedKernel kernel) {
  switch (kernel) {
    case BedKernel::kAvx512:
      return "AVX-512";
    case BedKernel::kAvx2:
      return "AVX2";
    default:
      return "scalar";
  }
}

std::vector<BedKernel> bed_kernels() {
  std::vector<BedKernel> kernels = {BedKernel::kScalar};
  if (!__builtin_cpu_supports("avx2")) return kernels;
  kernels.push_back(BedKernel::kAvx2);
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512dq")) {
    kernels.push_back(BedKernel::kAvx512);
  }
  return kernels;
}

const BedFunctions& bed_functions(BedKernel kernel) {
  const std::vector<BedKernel> present = bed_kernels();
  if (std::find(present.begin(), present.end(), kernel) == present.end()) {
    throw InputError(std::string("particles: this processor has no ") + bed_kernel_name(kernel));
  }
  switch (kernel) {
    case BedKernel::kAvx512:
      return kAvx512BedFunctions;
    case BedKernel::kAvx2:
      return kAvx2BedFunctions;
    default:
      return kScalarBedFunctions;
  }
}

}  // namespace screed
