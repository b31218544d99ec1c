// Keeps a robot that has no map on its site.
#include "firmware/leveling/site_fence.h"

namespace screed {
namespace {

constexpr Angle kAhead = 8192;  // 45 degrees either side
constexpr YawRate kMaxTurnRate = yaw_rate_from_degrees(60);
constexpr int16_t kMaxDistance_mm = 32000;  // beyond any radius; two squares of it fit 32 bits

bool beyond(int32_t x_mm, int32_t y_mm, int32_t radius_mm) {
  const int32_t x = limit_i16(x_mm, kMaxDistance_mm);
  const int32_t y = limit_i16(y_mm, kMaxDistance_mm);
  return static_cast<uint32_t>(x * x) + static_cast<uint32_t>(y * y) >
         static_cast<uint32_t>(radius_mm * radius_mm);
}

}  // namespace

SCREED_OUT_OF_LINE bool SiteFence::update(int32_t x_mm, int32_t y_mm) {
  if (radius_mm_ == 0) return false;
  const int32_t radius = radius_mm_;
  returning_ = beyond(x_mm, y_mm, returning_ ? asr(radius * 3, 2) : radius);
  return returning_;
}

MotionCommand SiteFence::steer(int32_t x_mm, int32_t y_mm, Angle heading) const {
  const Angle home = atan2_angle(-y_mm, -x_mm);
  const Angle error = angle_difference(home, heading);
  // Two turns of the error a second, as fast as the robot turns well: time constant 0.5 s.
  const YawRate rate = limit_i16(static_cast<int32_t>(error) * 2, kMaxTurnRate);
  const bool ahead = error > static_cast<Angle>(-kAhead) && error < kAhead;
  return {ahead ? speed_mm_per_s_ : static_cast<int16_t>(0), rate};
}

}  // namespace screed
