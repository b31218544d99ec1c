// The leveling algorithms of thesis 7.1.1 as one state machine a tick.
#include "firmware/leveling/leveling.h"

namespace screed {
namespace {

// A climb that meets neither decline nor incline for this long has reached a plateau, not a peak.
constexpr uint16_t kPlateauTicks = 3 * kTickRate_hz;

}  // namespace

Leveling::Leveling(const Parameters& parameters)
    : algorithm_(static_cast<LevelingAlgorithm>(parameters.algorithm)),
      threshold_(angle_from_centidegrees(parameters.climb_threshold)),
      hysteresis_(angle_from_centidegrees(parameters.climb_hysteresis)),
      climb_speed_(parameters.climb_speed),
      spin_rate_(yaw_rate_from_degrees(parameters.spin_rate)),
      spin_ticks_(ticks_from_ms(parameters.spin_time)),
      walk_(parameters),
      fence_(parameters.site_radius, parameters.walk_speed_max)
#if SCREED_TRAINING_DRIVE
      ,
      training_(parameters)
#endif
{
}

void Leveling::start() {
  state_ = LevelingState::kIdle;
  ticks_in_state_ = 0;
}

void Leveling::enter(LevelingState next) {
  if (next == state_) {
    if (ticks_in_state_ < UINT16_MAX) ++ticks_in_state_;
    return;
  }
  if (state_ == LevelingState::kClimb && next != LevelingState::kReturn) ++peaks_;
  if (next == LevelingState::kWalk) walk_.restart();
  state_ = next;
  ticks_in_state_ = 1;
}

// Algorithm 6: above the threshold climb straight on, below it walk at random.
LevelingState Leveling::next_hill_sensing(Angle pitch) const {
  const Angle limit =
      state_ == LevelingState::kClimb ? static_cast<Angle>(threshold_ - hysteresis_) : threshold_;
  return pitch > limit ? LevelingState::kClimb : LevelingState::kWalk;
}

// "An approach ... could continue on a straight path when an incline is detected, but instead begin
// a spinning maneuver once a decline is detected" (7.1.1). Between incline and decline the path
// goes on straight.
LevelingState Leveling::next_spin_on_peak(Angle pitch) {
  switch (state_) {
    case LevelingState::kClimb:
      if (pitch < static_cast<Angle>(-hysteresis_)) {
        spin_left_ = !spin_left_;
        return LevelingState::kSpin;
      }
      if (pitch > static_cast<Angle>(threshold_ - hysteresis_)) ticks_in_state_ = 0;
      return ticks_in_state_ < kPlateauTicks ? LevelingState::kClimb : LevelingState::kWalk;
    case LevelingState::kSpin:
      return ticks_in_state_ < spin_ticks_ ? LevelingState::kSpin : LevelingState::kWalk;
    default:
      return pitch > threshold_ ? LevelingState::kClimb : LevelingState::kWalk;
  }
}

MotionCommand Leveling::motion() {
  switch (state_) {
    case LevelingState::kWalk:
      return walk_.tick();
    case LevelingState::kClimb:
      return {climb_speed_, 0};
    case LevelingState::kSpin:
      return {0, spin_left_ ? spin_rate_ : static_cast<YawRate>(-spin_rate_)};
    default:
      return {0, 0};
  }
}

MotionCommand Leveling::tick(const LevelingInput& input, const MotionCommand& drive) {
  if (algorithm_ == LevelingAlgorithm::kDrive) {
    enter(LevelingState::kDrive);
    return drive;
  }
#if SCREED_TRAINING_DRIVE
  if (algorithm_ == LevelingAlgorithm::kTrainingDrive) {
    const MotionCommand motion = training_.tick();
    enter(training_.finished() ? LevelingState::kDone : LevelingState::kTrainingDrive);
    return motion;
  }
#endif
  // A spin stays where it is; all other states respect the fence.
  if (state_ != LevelingState::kSpin && fence_.outside(input.x_mm, input.y_mm)) {
    enter(LevelingState::kReturn);
    return fence_.steer(input.x_mm, input.y_mm, input.heading);
  }
  enter(algorithm_ == LevelingAlgorithm::kHillSensing ? next_hill_sensing(input.pitch)
                                                      : next_spin_on_peak(input.pitch));
  return motion();
}

}  // namespace screed
