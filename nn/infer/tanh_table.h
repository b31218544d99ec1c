// The values of tanh_q15 at the ends of its 128 segments: (value + 1/2) / 2^15 at
// (256 i + 1/2) / 2^13, raised by half the sag of the chord so that the error is the same on both
// sides.
#pragma once

#include <stdint.h>

#include "hal/program_memory.h"

namespace screed {
namespace nn {

extern "C" const int16_t screed_nn_tanh_table[129];  // in program memory

}  // namespace nn
}  // namespace screed
