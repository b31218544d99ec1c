// What the leveling algorithms have in common.
#include "firmware/leveling/behaviour.h"

namespace screed {
namespace {

constexpr YawRate kMaxTurnRate = yaw_rate_from_degrees(60);

}  // namespace

Behaviour::Behaviour(const Parameters& parameters)
    : parameters_(parameters), walk_(parameters), fence_(parameters) {}

void Behaviour::start() {
  state_ = LevelingState::kIdle;
  ticks_in_state_ = 0;
}

void Behaviour::enter_or_stay(LevelingState next) {
  if (next == state_) {
    if (ticks_in_state_ < UINT16_MAX) ++ticks_in_state_;
    return;
  }
  // One that fence, escape or search cut off came to no peak.
  if (state_ == LevelingState::kClimb && next != LevelingState::kReturn &&
      next != LevelingState::kEscape && next != LevelingState::kSeekWall) {
    ++peaks_;
  }
  if (next == LevelingState::kWalk) walk_.restart();
  state_ = next;
  ticks_in_state_ = 1;
}

MotionCommand Behaviour::enter_or_stay(LevelingState state, MotionCommand motion) {
  enter_or_stay(state);
  return motion;
}

SCREED_OUT_OF_LINE bool Behaviour::uphill(Angle pitch) const {
  Angle limit = angle_from_centidegrees(parameters_.climb_threshold);
  if (state_ == LevelingState::kClimb) limit = static_cast<Angle>(limit - hysteresis());
  return pitch > limit;
}

MotionCommand Behaviour::walk() {
  enter_or_stay(LevelingState::kWalk);
  return walk_.tick();
}

// The slope vector in the robot's axes is (pitch, roll): angles stand in for tangents, which turns
// it by less than 4 degrees on slopes up to 25. On a plateau it is noise.
MotionCommand Behaviour::climb(const LevelingInput& input) {
  enter_or_stay(LevelingState::kClimb);
  if (parameters_.climb_turn == 0 || !uphill(input.pitch)) return {parameters_.climb_speed, 0};
  const Angle steepest = atan2_angle(input.roll, input.pitch);
  return {parameters_.climb_speed,
          limit_i16(mul_i16(parameters_.climb_turn, steepest), kMaxTurnRate)};
}

bool Behaviour::update_return(const LevelingInput& input) {
  // A spin stays where it is.
  return state_ != LevelingState::kSpin && fence_.update(input.place);
}

MotionCommand Behaviour::return_to_site(const LevelingInput& input) {
  return enter_or_stay(LevelingState::kReturn,
                       fence_.steer(static_cast<int16_t>(-input.place.mm[kX]),
                                    static_cast<int16_t>(-input.place.mm[kY]), input.heading));
}

}  // namespace screed
