// The legs of the random walk of Algorithm 6.
#include "firmware/leveling/walk_legs.h"

namespace screed {

WalkLegs::WalkLegs(const Parameters& parameters)
    : random_(static_cast<uint16_t>(parameters.random_seed)),
      speed_min_(parameters.walk_speed_min),
      speed_max_(parameters.walk_speed_max),
      yaw_rate_max_(yaw_rate_from_degrees(parameters.walk_yaw_rate_max)),
      leg_min_ms_(parameters.walk_leg_min),
      leg_max_ms_(parameters.walk_leg_max) {}

MotionCommand WalkLegs::tick() {
  if (ticks_left_ == 0) {
    leg_.speed_mm_per_s = random_.uniform(speed_min_, speed_max_);
    leg_.yaw_rate = random_.uniform(static_cast<int16_t>(-yaw_rate_max_), yaw_rate_max_);
    ticks_left_ = ticks_from_ms(random_.uniform(leg_min_ms_, leg_max_ms_));
  }
  --ticks_left_;
  return leg_;
}

}  // namespace screed
