// Which vector instructions a kernel is computed with: the best that the processor has, or another
// for tests. All give the same bits: they round each operation by itself and sum in one order.
#pragma once

#include <cstdint>
#include <vector>

namespace screed {

/// kBaseline: what every processor has. kAvx512: with VNNI.
enum class InstructionSet : uint8_t { kBaseline, kAvx2, kAvx512 };

/// Those that this processor has, the best one last; not beyond the one that the environment's
/// SCREED_INSTRUCTIONS names. Throws InputError when it names none.
const std::vector<InstructionSet>& instruction_sets();

const char* name_of(InstructionSet set);

}  // namespace screed
