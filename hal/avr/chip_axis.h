// How the sensors lie in the robot: for kImuAxes of a board's pins.h.
#pragma once

#include <stdint.h>

namespace screed {
namespace avr {

/// Where the robot's axis i (x forward, y left, z up) comes from: an axis of the chips, reversed
/// or not.
struct ChipAxis {
  uint8_t index;
  bool reversed;
};

}  // namespace avr
}  // namespace screed
