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
    : StrokesMemory(),
      parameters_(parameters),
      random_(static_cast<uint16_t>(parameters.random_seed)),
      site_(parameters),
      limit_(kFirstLimit),
      down_ticks_(static_cast<uint8_t>(ticks_from_ms(parameters.stroke_down))),
      up_ticks_(static_cast<uint8_t>(ticks_from_ms(parameters.stroke_up))) {
  begin_journey();
}

void Strokes::begin(Phase phase, uint16_t ticks) {
  phase_ = phase;
  ticks_left_ = ticks;
}

void Strokes::begin_cycle() {
  cycle_ticks_ = static_cast<uint8_t>(down_ticks_ + up_ticks_);
}

void Strokes::begin_journey() {
  site_.draw_place_at_edge(random_, kFromEdge_mm, target_mm_);
  begin(Phase::kTravel, kTravelTicks);
}

MotionCommand Strokes::travel(const LevelingInput& input, Behaviour& behaviour) {
  if (ticks_left_ < kTravelTicks - kApartTicks &&
      mul_i16(pitch_, pitch_) + mul_i16(roll_, roll_) > mul_i16(limit_, limit_)) {
    limit_ = static_cast<Angle>(limit_ + asr_i16(limit_, kRise));
    downhill_ = pitch_ < 0;  // the way that takes the shorter turn
    begin(Phase::kFace, kFaceTicks);
    return face(behaviour);
  }
  const auto east = static_cast<int16_t>(target_mm_[kX] - input.place.mm[kX]);
  const auto north = static_cast<int16_t>(target_mm_[kY] - input.place.mm[kY]);
  if (ticks_left_ == 0 || (abs_i16(east) < kArrived_mm && abs_i16(north) < kArrived_mm)) {
    limit_ = static_cast<Angle>(limit_ - asr_i16(limit_, kFall));
    if (limit_ < kMinLimit) limit_ = kMinLimit;
    begin_journey();
  }
  return behaviour.enter_or_stay(LevelingState::kWalk, behaviour.steer(east, north, input.heading));
}

MotionCommand Strokes::face(Behaviour& behaviour) {
  Angle turn = atan2_angle(roll_, pitch_);
  if (downhill_) turn = angle_difference(turn, INT16_MIN);
  if (abs_i16(turn) < kFacing || ticks_left_ == 0) {
    begin(Phase::kStroke, ticks_from_ms(parameters_.stroke_time));
    begin_cycle();
    speed_ = 0;
    return stroke(behaviour);
  }
  return behaviour.enter_or_stay(LevelingState::kWalk,
                                 {0, limit_i16(static_cast<int32_t>(turn) * 2, kMaxTurnRate)});
}

MotionCommand Strokes::stroke(Behaviour& behaviour) {
  if (cycle_ticks_ == 0) {
    const auto uphill = downhill_ ? static_cast<Angle>(-pitch_) : pitch_;
    if (ticks_left_ == 0 || uphill < asr_i16(limit_, 1)) {
      begin(Phase::kTravel, kTravelTicks);  // on to the same place
      return behaviour.enter_or_stay(LevelingState::kWalk, {0, 0});
    }
    begin_cycle();
  }
  --cycle_ticks_;
  if (cycle_ticks_ < up_ticks_) {
    speed_ = kSpeed_mm_per_s;
  } else {
    speed_ = static_cast<int16_t>(speed_ - parameters_.stroke_ease);  // 0.1 m/s^2: mm/s a tick
    if (speed_ < -kSpeed_mm_per_s) speed_ = -kSpeed_mm_per_s;
  }
  return behaviour.enter_or_stay(LevelingState::kStroke,
                                 {downhill_ ? static_cast<int16_t>(-speed_) : speed_, 0});
}

MotionCommand Strokes::tick(const LevelingInput& input, Behaviour& behaviour) {
  const LevelingState state = behaviour.state();
  follow(pitch_, input.pitch);
  follow(roll_, input.roll);
  // Something came between: the return to the site, an escape. That place may be out of reach.
  if (state != LevelingState::kWalk && state != LevelingState::kStroke) {
    begin_journey();
  }
  if (ticks_left_ != 0) --ticks_left_;
  if (phase_ == Phase::kFace) return face(behaviour);
  if (phase_ == Phase::kStroke) return stroke(behaviour);
  return travel(input, behaviour);
}

}  // namespace screed
