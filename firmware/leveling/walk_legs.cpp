// The legs of the random walk of Algorithm 6.
#include "firmware/leveling/walk_legs.h"

namespace screed {

WalkLegs::WalkLegs(const Parameters& parameters)
    : random_(static_cast<uint16_t>(parameters.random_seed())), parameters_(parameters) {}

MotionCommand WalkLegs::tick() {
  if (ticks_left_ == 0) {
    leg_.speed_mm_per_s =
        random_.uniform(parameters_.walk_speed_min(), parameters_.walk_speed_max());
    const YawRate fastest = yaw_rate_from_degrees(parameters_.walk_yaw_rate_max());
    leg_.yaw_rate = random_.uniform(static_cast<YawRate>(-fastest), fastest);
    ticks_left_ =
        ticks_from_ms(random_.uniform(parameters_.walk_leg_min(), parameters_.walk_leg_max()));
  }
  --ticks_left_;
  return leg_;
}

}  // namespace screed
