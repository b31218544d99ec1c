// A track as its speed control knows it: what the slip watch asks of the control.
#pragma once

#include <stdint.h>

namespace screed {

struct TrackMotion {
  int16_t speed_dmm_per_s;  ///< observed, 0.1 mm/s
  int16_t effort;           ///< duty beyond what drives the unloaded track
};

}  // namespace screed
