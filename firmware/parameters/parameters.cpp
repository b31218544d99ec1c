// The range check of the parameters, over a table: comparisons written out are three times as
// long.
#include "firmware/parameters/parameters.h"

#include "hal/program_memory.h"

namespace screed {
namespace {

const int16_t kRanges[][2] SCREED_PROGRAM_MEMORY = {
#define SCREED_RANGE(name, unit, min, max, value, meaning) {min, max},
    SCREED_PARAMETERS(SCREED_RANGE)
#undef SCREED_RANGE
};
constexpr uint8_t kCount = sizeof(kRanges) / sizeof(kRanges[0]);
static_assert(sizeof(Parameters) == kCount * sizeof(int16_t), "parameters are numbers alone");

}  // namespace

bool Parameters::valid() const {
  const auto* value = reinterpret_cast<const int16_t*>(this);
  for (uint8_t i = 0; i < kCount; ++i, ++value) {
    if (*value < read_program_i16(&kRanges[i][0]) || *value > read_program_i16(&kRanges[i][1]))
      return false;
  }
  // Their numbers follow each other, or the range has let one pass that there is not.
  constexpr bool kGapless = (kAlgorithmsInBuild & (kAlgorithmsInBuild + 1U)) == 0;
  if (!kGapless && !algorithm_in_build(algorithm)) return false;
  return walk_speed_min <= walk_speed_max && walk_leg_min <= walk_leg_max;
}

}  // namespace screed
