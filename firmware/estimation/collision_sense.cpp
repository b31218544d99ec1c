// Collisions, by inertia.
//
// In units of 1/20 mm/s, about what two accelerometer counts gain in a tick (0.48 of 0.1 mm/s); v:
// mean speed of the tracks, a: specific force ahead
//   residual = dv - (a - g sin pitch) T - mean,   mean += residual / 64
//   lost    += residual - lost / 4
#include "firmware/estimation/collision_sense.h"

namespace screed {
namespace {

constexpr int16_t kMinLost = 600;  // 30 mm/s
constexpr int16_t kMaxChange = 2000;

}  // namespace

bool CollisionSense::tick(int16_t left_dmm_per_s, int16_t right_dmm_per_s, int16_t accel_ahead,
                          int16_t sin_pitch_q14) {
  const auto speed = static_cast<int16_t>(asr_i16(left_dmm_per_s, 1) + asr_i16(right_dmm_per_s, 1));
  const int16_t change =
      static_cast<int16_t>(static_cast<uint16_t>(speed) - static_cast<uint16_t>(speed_));
  speed_ = speed;
  // No track gains more than 200 mm/s in a tick.
  const int16_t gained = limit_i16(change, kMaxChange);
  const auto force = static_cast<int16_t>(asr_i16(accel_ahead, 1) - asr_i16(sin_pitch_q14, 3));
  const auto residual = static_cast<int16_t>(gained * 2 - force - asr_i16(mean_q6_, 6));
  mean_q6_ = limit_i16(static_cast<int32_t>(mean_q6_) + residual, INT16_MAX);
  lost_ = limit_i16(static_cast<int32_t>(lost_) - asr_i16(lost_, 2) + residual, INT16_MAX);
  const int16_t lost = speed < 0 ? static_cast<int16_t>(-lost_) : lost_;
  const uint16_t fast = abs_i16(speed);
  // Half of the speed: 1 for each 0.1 mm/s.
  if (fast >= kMinSpeed_dmm_per_s && lost >= kMinLost && static_cast<uint16_t>(lost) >= fast) {
    const bool first = ticks_since_ != 0;
    ticks_since_ = 0;
    return first;
  }
  if (ticks_since_ < kMemoryTicks) ++ticks_since_;
  return false;
}

}  // namespace screed
