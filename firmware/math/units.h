// From the units of the parameter table (for people) to those of the core (for arithmetic). Each
// rounds down.
#pragma once

#include <stdint.h>

#include "firmware/math/fixed.h"
#include "firmware/math/trig.h"
#include "hal/sample.h"

namespace screed {

/// Yaw rates are angle units (65536 = one turn) per second: 45 degrees/s = 8192. int16_t spans 180
/// degrees/s either way.
using YawRate = int16_t;

/// 0.01 degree -> angle units; error below 0.01 %. Any int16_t up to +-17999 (less than half a
/// turn). 59652 / 2^15 = 65536 / 36000.
SCREED_OUT_OF_LINE constexpr Angle angle_from_centidegrees(int16_t centidegrees) {
  return static_cast<Angle>(asr(static_cast<int32_t>(centidegrees) * 59652, 15));
}

/// Angle units -> 0.01 degree, -18000..17999.
constexpr int16_t centidegrees_from_angle(Angle angle) {
  return static_cast<int16_t>(asr(static_cast<int32_t>(angle) * 36000, 16));
}

/// degrees/s -> angle units/s; +-179 degrees/s. 46603 / 2^8 = 65536 / 360.
SCREED_OUT_OF_LINE constexpr YawRate yaw_rate_from_degrees(int16_t degrees_per_s) {
  return static_cast<YawRate>(asr(static_cast<int32_t>(degrees_per_s) * 46603, 8));
}

/// ms -> control ticks, rounded down; 0..32767 ms.
SCREED_OUT_OF_LINE constexpr uint16_t ticks_from_ms(int16_t ms) {
  return static_cast<uint16_t>((static_cast<uint32_t>(ms) * 52429U) >>
                               19);  // exact for all 0..43698
}
static_assert(kTickPeriod_us == 10000, "ticks_from_ms divides by 10 ms");

}  // namespace screed
