// The range check of the parameters, over a table: comparisons written out are three times as
// long. And the hosts' table.
#include "firmware/parameters/parameters.h"

#include "firmware/parameters/algorithms_in_build.h"
#include "hal/program_memory.h"

namespace screed {

namespace {

// Flash is scarce and the least value small, or the greatest one with the other sign: seven bits
// say which, and the eighth whether the parameter changes while the robot runs.
constexpr uint8_t kSymmetric = 0x7F;
constexpr uint8_t kLive = 0x80;

constexpr bool is_live(uint8_t number) {
#define SCREED_LIVE(name) || number == Parameters::k_##name
  return false SCREED_LIVE_PARAMETERS(SCREED_LIVE);
#undef SCREED_LIVE
}
constexpr uint8_t packed_min(uint8_t number, int16_t min) {
  return static_cast<uint8_t>((is_live(number) ? kLive : 0) |
                              (min < 0 ? kSymmetric : static_cast<uint8_t>(min)));
}
#define SCREED_FITS(name, unit, min, max, value, meaning) \
  static_assert((min) == -(max) || ((min) >= 0 && (min) < kSymmetric), "least value of " #name);
SCREED_PARAMETERS(SCREED_FITS)
#undef SCREED_FITS

struct Range {
  uint8_t min;
  int16_t max;
};
const Range kRanges[Parameters::kCount] SCREED_PROGRAM_MEMORY = {
#define SCREED_RANGE(name, unit, min, max, value, meaning) \
  {packed_min(Parameters::k_##name, min), max},
    SCREED_PARAMETERS(SCREED_RANGE)
#undef SCREED_RANGE
};

// Algorithms below the greatest number that this build leaves out; of a single one the number.
constexpr uint16_t kGaps = kAllAlgorithms & ~kAlgorithmsInBuild & ((1U << kMaxAlgorithm) - 1U);
constexpr bool kOneGap = bits_of(kGaps) == 1;
constexpr int16_t kGap = bits_of(static_cast<uint16_t>(kGaps - 1U));

}  // namespace

#ifndef __AVR__
const ParameterInfo kParameterTable[Parameters::kCount] = {
#define SCREED_INFO(name, unit, min, max, value, meaning) \
  {Parameters::k_##name, #name, unit, min, max, value, meaning},
    SCREED_PARAMETERS(SCREED_INFO)
#undef SCREED_INFO
};
#endif

bool changes_while_running(uint8_t number) {
  return (read_program_u8(&kRanges[number].min) & kLive) != 0;
}

bool Parameters::valid() const {
  const int16_t* value = values;
  for (const Range* range = kRanges; range != kRanges + kCount; ++range, ++value) {
    int16_t min = read_program_u8(&range->min) & kSymmetric;
    const int16_t max = read_program_i16(&range->max);
    if (min == kSymmetric) min = static_cast<int16_t>(-max);
    if (*value < min || *value > max) return false;
  }
  // The algorithms' numbers follow each other, or the range has let one pass that there is not.
  if (kOneGap) {
    if (algorithm() == kGap) return false;
  } else if (kGaps != 0 && !algorithm_in_build(algorithm())) {
    return false;
  }
  return walk_speed_min() <= walk_speed_max() && walk_leg_min() <= walk_leg_max();
}

}  // namespace screed
