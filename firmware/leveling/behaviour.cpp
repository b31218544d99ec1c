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
  backwards_ = false;
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

SCREED_OUT_OF_LINE bool Behaviour::uphill(const LevelingInput& input) const {
  int16_t limit = parameters_.climb_threshold();
  if (state_ == LevelingState::kClimb)
    limit = static_cast<int16_t>(limit - parameters_.climb_hysteresis());
  return ahead(input.pitch) > angle_from_centidegrees(limit);
}

Angle Behaviour::ahead(Angle angle) const {
  return backwards_ ? static_cast<Angle>(-angle) : angle;
}

MotionCommand Behaviour::motion_ahead(MotionCommand motion) const {
  motion.speed_mm_per_s = ahead(motion.speed_mm_per_s);
  return motion;
}

MotionCommand Behaviour::walk() {
  enter_or_stay(LevelingState::kWalk);
  return motion_ahead(walk_.tick());
}

// The slope vector in the robot's axes is (pitch, roll): angles stand in for tangents, which turns
// it by less than 4 degrees on slopes up to 25. On a plateau it is noise.
MotionCommand Behaviour::climb(const LevelingInput& input) {
  enter_or_stay(LevelingState::kClimb);
  MotionCommand motion = {parameters_.climb_speed(), 0};
  if (parameters_.climb_turn() != 0 && uphill(input)) {
    const Angle steepest = atan2_angle(ahead(input.roll), ahead(input.pitch));
    motion.yaw_rate = limit_i16(mul_i16(parameters_.climb_turn(), steepest), kMaxTurnRate);
  }
  return motion_ahead(motion);
}

bool Behaviour::return_to_site(const LevelingInput& input, MotionCommand& motion) {
  // A spin stays where it is.
  if (state_ == LevelingState::kSpin || !fence_.update(input.place)) return false;
  // To the middle: the robot seen from there, half a turn on.
  motion = fence_.steer(input.place.mm[kX], input.place.mm[kY],
                        static_cast<Angle>(input.heading ^ INT16_MIN));
  if (motion.speed_mm_per_s != 0) {
    const bool backwards = motion.speed_mm_per_s < 0;
    backwards_ = backwards;
    if (backwards == input.backwards) return false;
  }
  enter_or_stay(LevelingState::kReturn);
  return true;
}

}  // namespace screed
