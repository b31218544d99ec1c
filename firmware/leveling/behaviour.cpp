// What the leveling algorithms have in common.
#include "firmware/leveling/behaviour.h"

namespace screed {

Behaviour::Behaviour(const Parameters& parameters)
    : threshold_(angle_from_centidegrees(parameters.climb_threshold)),
      hysteresis_(angle_from_centidegrees(parameters.climb_hysteresis)),
      climb_speed_(parameters.climb_speed),
      walk_(parameters),
      fence_(parameters.site_radius, parameters.walk_speed_max) {}

void Behaviour::start() {
  state_ = LevelingState::kIdle;
  ticks_in_state_ = 0;
}

void Behaviour::enter_or_stay(LevelingState next) {
  if (next == state_) {
    if (ticks_in_state_ < UINT16_MAX) ++ticks_in_state_;
    return;
  }
  if (state_ == LevelingState::kClimb && next != LevelingState::kReturn) ++peaks_;
  if (next == LevelingState::kWalk) walk_.restart();
  state_ = next;
  ticks_in_state_ = 1;
}

MotionCommand Behaviour::enter_or_stay(LevelingState state, MotionCommand motion) {
  enter_or_stay(state);
  return motion;
}

SCREED_OUT_OF_LINE bool Behaviour::uphill(Angle pitch) const {
  const Angle limit =
      state_ == LevelingState::kClimb ? static_cast<Angle>(threshold_ - hysteresis_) : threshold_;
  return pitch > limit;
}

MotionCommand Behaviour::walk() {
  enter_or_stay(LevelingState::kWalk);
  return walk_.tick();
}

MotionCommand Behaviour::climb() {
  return enter_or_stay(LevelingState::kClimb, {climb_speed_, 0});
}

bool Behaviour::update_return(const LevelingInput& input) {
  // A spin stays where it is.
  return state_ != LevelingState::kSpin && fence_.update(input.x_mm, input.y_mm);
}

MotionCommand Behaviour::return_to_site(const LevelingInput& input) {
  return enter_or_stay(LevelingState::kReturn, fence_.steer(input.x_mm, input.y_mm, input.heading));
}

}  // namespace screed
