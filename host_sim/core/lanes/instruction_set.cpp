#include "host_sim/core/lanes/instruction_set.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string>

#include "host_sim/core/errors.h"

namespace screed {
namespace {

constexpr std::array<const char*, 3> kNames = {"baseline", "AVX2", "AVX-512"};

bool processor_has([[maybe_unused]] InstructionSet set) {
#ifdef __x86_64__
  if (set == InstructionSet::kAvx2) return __builtin_cpu_supports("avx2");
  if (set == InstructionSet::kAvx512) {
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw") &&
           __builtin_cpu_supports("avx512vnni");
  }
#endif
  return set == InstructionSet::kBaseline;
}

/// How many of kNames may be used.
size_t allowed_count() {
  const char* const asked = std::getenv("SCREED_INSTRUCTIONS");
  if (asked == nullptr) return kNames.size();
  const auto* const found = std::find(kNames.begin(), kNames.end(), std::string(asked));
  if (found == kNames.end()) {
    throw InputError("SCREED_INSTRUCTIONS = \"" + std::string(asked) +
                     "\"; allowed: baseline, AVX2, AVX-512");
  }
  return static_cast<size_t>(found - kNames.begin()) + 1;
}

std::vector<InstructionSet> found_sets() {
  std::vector<InstructionSet> sets;
  for (size_t i = 0; i < allowed_count(); ++i) {
    if (processor_has(static_cast<InstructionSet>(i)))
      sets.push_back(static_cast<InstructionSet>(i));
  }
  return sets;
}

}  // namespace

const std::vector<InstructionSet>& instruction_sets() {
  static const std::vector<InstructionSet> sets = found_sets();
  return sets;
}

const char* name_of(InstructionSet set) {
  return kNames.at(static_cast<size_t>(set));
}

}  // namespace screed
