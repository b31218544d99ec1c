// A place on the plane and how well it is known: what position estimate, leveling and telemetry
// share.
#pragma once

#include <stdint.h>

namespace screed {

enum Axis : uint8_t { kX, kY };  ///< east, north

/// Relative to where the run began, or in the frame of the position fixes once there was one.
struct Place {
  int16_t mm[2];     ///< stops at +-32767
  uint8_t sigma[2];  ///< standard deviation, 4 mm; 255: that, or more
};

}  // namespace screed
