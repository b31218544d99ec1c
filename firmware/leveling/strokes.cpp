// Carries ground by strokes, the way that levels the site.
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
constexpr uint16_t kAheadTicks = 60;  // from one work to the next of a row
constexpr uint16_t kAwayTicks = 150;  // so much more travel where a wall ends the row
constexpr int16_t kAheadSpeed_mm_per_s = 200;

// Flow from which on it works, 1/16 of the map's unit: at first, at least, and by how much it
// changes.
constexpr uint8_t kLimitShift = 4;
constexpr int16_t kFirstLimit = 10880;
constexpr int16_t kMinLimit = 352;
constexpr uint8_t kFall = 3;  // by 2^-3 after every journey
constexpr uint8_t kRise = 6;  // by 2^-6 with every work

}  // namespace

Strokes::Strokes(const Parameters& parameters)
    : parameters_(parameters),
      random_(static_cast<uint16_t>(parameters.random_seed())),
      map_(parameters),
      limit_(kFirstLimit) {
  begin_journey();
}

void Strokes::look(const LevelingInput& input) {
  int16_t from[2];
  map_.source(input, from);
  state_.from_ahead = from[0];
  state_.direction = atan2_angle(from[1], from[0]);
  turn_vector_back(from, state_.direction);
  state_.flow = from[0];
}

void Strokes::begin(Phase phase, uint16_t ticks) {
  state_.phase = phase;
  state_.ticks_left = ticks;
}

void Strokes::begin_cycle() {
  state_.cycle_ticks = static_cast<uint8_t>(ticks_from_ms(parameters_.stroke_down()) +
                                            ticks_from_ms(parameters_.stroke_up()));
}

void Strokes::begin_journey() {
  map_.site().draw_place_at_edge(random_, kFromEdge_mm, state_.target_mm);
  begin(Phase::kTravel, kTravelTicks);
}

MotionCommand Strokes::travel(const LevelingInput& input, Behaviour& behaviour) {
  if (state_.ticks_left < kTravelTicks - kApartTicks &&
      state_.flow > asr_i16(limit_, kLimitShift)) {
    limit_ = static_cast<int16_t>(limit_ + asr_i16(limit_, kRise));
    state_.backwards = state_.from_ahead < 0;  // the way that takes the shorter turn
    begin(Phase::kFace, kFaceTicks);
    return face(behaviour);
  }
  const auto east = static_cast<int16_t>(state_.target_mm[kX] - input.place.mm[kX]);
  const auto north = static_cast<int16_t>(state_.target_mm[kY] - input.place.mm[kY]);
  if (state_.ticks_left == 0 || (abs_i16(east) < kArrived_mm && abs_i16(north) < kArrived_mm)) {
    limit_ = static_cast<int16_t>(limit_ - asr_i16(limit_, kFall));
    if (limit_ < kMinLimit) limit_ = kMinLimit;
    begin_journey();
  }
  return behaviour.enter_or_stay(LevelingState::kWalk, behaviour.steer(east, north, input.heading));
}

MotionCommand Strokes::face(Behaviour& behaviour) {
  Angle turn = state_.direction;
  if (state_.backwards) turn = angle_difference(turn, INT16_MIN);
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
    const auto flow =
        state_.backwards ? static_cast<int16_t>(-state_.from_ahead) : state_.from_ahead;
    const bool done = flow < asr_i16(limit_, kLimitShift + 1);
    if (done || state_.ticks_left == 0) {
      if (done) {
        begin(Phase::kTravel, kTravelTicks);  // on to the same place
      } else {
        begin(Phase::kAhead, kAheadTicks);
      }
      return behaviour.enter_or_stay(LevelingState::kWalk, {0, 0});
    }
    begin_cycle();
  }
  --state_.cycle_ticks;
  if (state_.cycle_ticks < ticks_from_ms(parameters_.stroke_up())) {
    state_.speed = kSpeed_mm_per_s;
  } else {
    state_.speed =
        static_cast<int16_t>(state_.speed - parameters_.stroke_ease());  // 0.1 m/s^2: mm/s a tick
    if (state_.speed < -kSpeed_mm_per_s) state_.speed = -kSpeed_mm_per_s;
  }
  return behaviour.enter_or_stay(
      LevelingState::kStroke,
      {state_.backwards ? static_cast<int16_t>(-state_.speed) : state_.speed, 0});
}

MotionCommand Strokes::ahead(const LevelingInput& input, Behaviour& behaviour) {
  if (state_.ticks_left == 0) {
    begin(Phase::kTravel, kTravelTicks - kApartTicks);  // it may work at once
  } else if (map_.site().near_edge(input.place.mm, kFromEdge_mm)) {
    begin_journey();
    state_.ticks_left = kTravelTicks + kAwayTicks;
  } else {
    return behaviour.enter_or_stay(LevelingState::kWalk, {kAheadSpeed_mm_per_s, 0});
  }
  return travel(input, behaviour);
}

MotionCommand Strokes::tick(const LevelingInput& input, Behaviour& behaviour) {
  const LevelingState state = behaviour.state();
  map_.tick(input, state == LevelingState::kWalk && state_.phase == Phase::kTravel);
  look(input);
  // Something came between: the return to the site, an escape. That place may be out of reach.
  if (state != LevelingState::kWalk && state != LevelingState::kStroke) {
    begin_journey();
  }
  if (state_.ticks_left != 0) --state_.ticks_left;
  if (state_.phase == Phase::kFace) return face(behaviour);
  if (state_.phase == Phase::kStroke) return stroke(behaviour);
  if (state_.phase == Phase::kAhead) return ahead(input, behaviour);
  return travel(input, behaviour);
}

}  // namespace screed
