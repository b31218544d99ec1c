// Keeps a robot that has no map on its site.
#include "firmware/leveling/site.h"

namespace screed {

namespace {

constexpr uint16_t kHalfTurn = 32768;
constexpr uint16_t kAhead = 8192;  // 45 degrees either side
constexpr YawRate kMaxTurnRate = yaw_rate_from_degrees(60);

uint32_t squares(int16_t x, int16_t y) {
  return static_cast<uint32_t>(mul_i16(x, x)) + static_cast<uint32_t>(mul_i16(y, y));
}

}  // namespace

SCREED_OUT_OF_LINE bool SiteFence::update(const Place& place) {
  if (parameters_.site_radius() == 0) return false;
  const uint8_t sigma = place.sigma[kX] > place.sigma[kY] ? place.sigma[kX] : place.sigma[kY];
  const int16_t half = asr_i16(parameters_.site_radius(), 1);
  auto radius = static_cast<int16_t>(parameters_.site_radius() - 4 * sigma);
  if (radius < half) radius = half;
  outside_ = squares(place.mm[kX], place.mm[kY]) > static_cast<uint32_t>(mul_i16(radius, radius));
  return outside_;
}

MotionCommand SiteFence::steer(int16_t east_mm, int16_t north_mm, Angle heading) const {
  // A turn is 2^16: sums wrap.
  auto error = static_cast<uint16_t>(angle_difference(atan2_angle(north_mm, east_mm), heading));
  int16_t speed = parameters_.walk_speed_max();
  if ((static_cast<uint16_t>(error + kQuarterTurn) & kHalfTurn) != 0) {  // behind: backwards
    error ^= kHalfTurn;
    speed = static_cast<int16_t>(-speed);
  }
  if (static_cast<uint16_t>(error + kAhead) >= 2 * kAhead) speed = 0;
  // Two turns of the error a second, as fast as the robot turns well: time constant 0.5 s.
  const int16_t half = clamp_i16(static_cast<Angle>(error), -kMaxTurnRate / 2, kMaxTurnRate / 2);
  return {speed, static_cast<YawRate>(half * 2)};
}

}  // namespace screed
