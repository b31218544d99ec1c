// Which vector instructions a kernel is computed with: the best that the processor has, or another
// for tests. All give the same bits: they round each operation by itself and sum in one order.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace screed {

enum class InstructionSet : uint8_t { kBaseline, kAvx2, kAvx512 };

/// Those that this processor has, the best one last.
inline std::vector<InstructionSet> instruction_sets() {
  std::vector<InstructionSet> sets = {InstructionSet::kBaseline};
  if (__builtin_cpu_supports("avx2")) sets.push_back(InstructionSet::kAvx2);
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl")) {
    sets.push_back(InstructionSet::kAvx512);
  }
  return sets;
}

constexpr const char* name_of(InstructionSet set) {
  constexpr std::array<const char*, 3> kNames = {"baseline", "AVX2", "AVX-512"};
  return kNames[static_cast<size_t>(set)];
}

}  // namespace screed
