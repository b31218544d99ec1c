// Feels when the robot drives against something hard: its inertia says that it has lost half of its
// speed within a few ticks, while its tracks go on. Digging in takes longer.
#pragma once

#include <stdint.h>

#include "firmware/math/fixed.h"

namespace screed {

class CollisionSense {
 public:
  /// One tick: speeds of both tracks, 0.1 mm/s; specific force ahead, 0.244 mg a count; sine of the
  /// pitch, Q14. Returns true in the tick in which it feels a collision.
  SCREED_OUT_OF_LINE bool tick(int16_t left_dmm_per_s, int16_t right_dmm_per_s, int16_t accel_ahead,
                               int16_t sin_pitch_q14);

  /// There was one within the last 2.5 s.
  bool recent() const { return ticks_since_ < kMemoryTicks; }

  static constexpr uint8_t kMemoryTicks = 250;
  static constexpr int16_t kMinSpeed_dmm_per_s = 500;  ///< of the robot, for a collision to be felt

 private:
  int16_t speed_ = 0;    ///< of the tracks in the tick before, 0.1 mm/s
  int16_t mean_q6_ = 0;  ///< of what the tracks gain more than the robot: sensor's bias, slope
  int16_t lost_ = 0;     ///< speed lost within a few ticks, 1/20 mm/s
  uint8_t ticks_since_ = kMemoryTicks;
};

}  // namespace screed
