// Moves the ground downhill by strokes.
#include "firmware/leveling/strokes.h"

namespace screed {
namespace {

constexpr int16_t kSpeed_mm_per_s = 250;
constexpr int16_t kFromEdge_mm = 115;  // there the robot touches the wall with its front
constexpr int16_t kArrived_mm = 40;
constexpr uint16_t kTravelTicks = 12 * kTickRate_hz;
constexpr uint16_t kApartTicks = kTickRate_hz / 2;  // of travel between two places of work
constexpr uint16_t kFaceTicks = 3 * kTickRate_hz;   // longest turn
constexpr Angle kFacing = angle_from_centidegrees(1000);
constexpr YawRate kMaxTurnRate = yaw_rate_from_degrees(90);
constexpr uint8_t kSlopeLag = 4;  // of the slope, 2^4 ticks

// Slope from which on it works: at first, at least, and by how much it changes.
constexpr Angle kFirstLimit = angle_from_centidegrees(800);
constexpr Angle kMinLimit = angle_from_centidegrees(200);
constexpr uint8_t kFall = 3;  // by 2^-3 after every journey
constexpr uint8_t kRise = 4;  // by 2^-4 with every work

void follow(Angle& lagging, Angle value) {
  lagging = wrap_angle(static_cast<int32_t>(lagging) +
                       asr_i16(angle_difference(value, lagging), kSlopeLag));
}

}  // namespace

Strokes::Strokes(const Parameters& parameters)
    : parameters_(parameters),
      random_(static_cast<uint16_t>(parameters.random_seed())),
      site_(parameters),
      limit_(kFirstLimit),
      down_ticks_(static_cast<uint8_t>(ticks_from_ms(parameters.stroke_down()))),
      up_ticks_(static_cast<uint8_t>(ticks_from_ms(parameters.stroke_up()))) {
  begin_journey();
}

void Strokes::begin(Phase phase, uint16_t ticks) {
  state_.phase = phase;
  state_.ticks_left = ticks;
}

void Strokes::begin_cycle() {
  state_.cycle_ticks = static_cast<uint8_t>(down_ticks_ + up_ticks_);
}

void Strokes::begin_journey() {
  site_.draw_place_at_edge(random_, kFromEdge_mm, state_.target_mm);
  begin(Phase::kTravel, kTravelTicks);
}

MotionCommand Strokes::travel(const LevelingInput& input, Behaviour& behaviour) {
  if (state_.ticks_left < kTravelTicks - kApartTicks &&
      mul_i16(state_.pitch, state_.pitch) + mul_i16(state_.roll, state_.roll) >
          mul_i16(limit_, limit_)) {
    limit_ = static_cast<Angle>(limit_ + asr_i16(limit_, kRise));
    state_.downhill = state_.pitch < 0;  // the way that takes the shorter turn
    begin(Phase::kFace, kFaceTicks);
    return face(behaviour);
  }
  const auto east = static_cast<int16_t>(state_.target_mm[kX] - input.place.mm[kX]);
  const auto north = static_cast<int16_t>(state_.target_mm[kY] - input.place.mm[kY]);
  if (state_.ticks_left == 0 || (abs_i16(east) < kArrived_mm && abs_i16(north) < kArrived_mm)) {
    limit_ = static_cast<Angle>(limit_ - asr_i16(limit_, kFall));
    if (limit_ < kMinLimit) limit_ = kMinLimit;
    begin_journey();
  }
  return behaviour.enter_or_stay(LevelingState::kWalk, behaviour.steer(east, north, input.heading));
}

MotionCommand Strokes::face(Behaviour& behaviour) {
  Angle turn = atan2_angle(state_.roll, state_.pitch);
  if (state_.downhill) turn = angle_difference(turn, INT16_MIN);
  if (abs_i16(turn) < kFacing || state_.ticks_left == 0) {
    begin(Phase::kStroke, ticks_from_ms(parameters_.stroke_time()));
    begin_cycle();
    state_.speed = 0;
    return stroke(behaviour);
  }
  return behaviour.enter_or_stay(LevelingState::kWalk,
                                 {0, limit_i16(static_cast<int32_t>(turn) * 2, kMaxTurnRate)});
}

MotionCommand Strokes::stroke(Behaviour& behaviour) {
  if (state_.cycle_ticks == 0) {
    const auto uphill = state_.downhill ? static_cast<Angle>(-state_.pitch) : state_.pitch;
    if (state_.ticks_left == 0 || uphill < asr_i16(limit_, 1)) {
      begin(Phase::kTravel, kTravelTicks);  // on to the same place
      return behaviour.enter_or_stay(LevelingState::kWalk, {0, 0});
    }
    begin_cycle();
  }
  --state_.cycle_ticks;
  if (state_.cycle_ticks < up_ticks_) {
    state_.speed = kSpeed_mm_per_s;
  } else {
    state_.speed =
        static_cast<int16_t>(state_.speed - parameters_.stroke_ease());  // 0.1 m/s^2: mm/s a tick
    if (state_.speed < -kSpeed_mm_per_s) state_.speed = -kSpeed_mm_per_s;
  }
  return behaviour.enter_or_stay(
      LevelingState::kStroke,
      {state_.downhill ? static_cast<int16_t>(-state_.speed) : state_.speed, 0});
}

MotionCommand Strokes::tick(const LevelingInput& input, Behaviour& behaviour) {
  const LevelingState state = behaviour.state();
  follow(state_.pitch, input.pitch);
  follow(state_.roll, input.roll);
  // Something came between: the return to the site, an escape. That place may be out of reach.
  if (state != LevelingState::kWalk && state != LevelingState::kStroke) {
    begin_journey();
  }
  if (state_.ticks_left != 0) --state_.ticks_left;
  if (state_.phase == Phase::kFace) return face(behaviour);
  if (state_.phase == Phase::kStroke) return stroke(behaviour);
  return travel(input, behaviour);
}

}  // namespace screed
