// Keeps a robot that has no map on its site.
#include "firmware/leveling/site_fence.h"

namespace screed {
namespace {

constexpr Angle kAhead = 8192;  // 45 degrees either side
constexpr YawRate kMaxTurnRate = yaw_rate_from_degrees(60);
uint32_t squares(int16_t x, int16_t y) {
  return static_cast<uint32_t>(mul_i16(x, x)) + static_cast<uint32_t>(mul_i16(y, y));
}

}  // namespace

SCREED_OUT_OF_LINE bool SiteFence::update(const Place& place) {
  if (radius_mm_ == 0) return false;
  const uint8_t sigma = place.sigma[kX] > place.sigma[kY] ? place.sigma[kX] : place.sigma[kY];
  auto radius = static_cast<int16_t>(radius_mm_ - 2 * 4 * sigma);
  const int16_t least = asr_i16(radius_mm_, 1);
  if (radius < least) radius = least;
  if (returning_) radius = static_cast<int16_t>(radius - asr_i16(radius, 2));
  returning_ = squares(place.mm[kX], place.mm[kY]) > squares(radius, 0);
  return returning_;
}

MotionCommand SiteFence::steer(int16_t east_mm, int16_t north_mm, Angle heading) const {
  const Angle there = atan2_angle(north_mm, east_mm);
  const Angle error = angle_difference(there, heading);
  // Two turns of the error a second, as fast as the robot turns well: time constant 0.5 s.
  const YawRate rate = limit_i16(static_cast<int32_t>(error) * 2, kMaxTurnRate);
  const bool ahead = error > static_cast<Angle>(-kAhead) && error < kAhead;
  return {ahead ? speed_mm_per_s_ : static_cast<int16_t>(0), rate};
}

}  // namespace screed
