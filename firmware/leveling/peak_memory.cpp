// Learns heights from slopes, goes to high places and spins there.
#include "firmware/leveling/peak_memory.h"

namespace screed {
namespace {

constexpr uint8_t kLearnTicks = 8;         // some 12 mm of driving
constexpr uint8_t kGain = 16;              // share of an error that corrects the map, 2^-8
constexpr uint8_t kChoice = 8;             // random places of which it goes to the highest
constexpr int16_t kDwell_ms_per_mm = 300;  // of spin, by height above the mean
constexpr int16_t kArrived_mm = 60;
constexpr uint16_t kGiveUpTicks = 12 * kTickRate_hz;
constexpr int16_t kFromEdge_mm = 150;      // half a diagonal of the robot: it spins beside a wall
constexpr int16_t kShortestSpin_ms = 300;  // a shorter one moves the tracks' slack

/// value * part / 256.
int16_t scaled(int16_t value, uint16_t part) {
  return static_cast<int16_t>(asr(static_cast<int32_t>(value) * part, 8));
}

int16_t between(int16_t from, int16_t to, uint8_t part) {
  return static_cast<int16_t>(from + scaled(static_cast<int16_t>(to - from), part));
}

}  // namespace

PeakMemory::PeakMemory(const Parameters& parameters)
    : parameters_(parameters),
      random_(static_cast<uint16_t>(parameters.random_seed())),
      site_(parameters) {}

PeakMemory::Spot PeakMemory::spot(const int16_t (&mm)[2]) const {
  Spot spot{0, {0, 0}};
  for (uint8_t axis = kY + 1; axis-- > kX;) {
    const int16_t half = site_.half_mm[axis];
    const int16_t inside = limit_i16(mm[axis], static_cast<int16_t>(half - 1));
    // 2^-8 of the distance of two heights
    const auto at =
        static_cast<uint16_t>((static_cast<int32_t>(inside) + half) * ((kSide - 1) * 128) / half);
    spot.south_west = static_cast<uint8_t>(spot.south_west * kSide + (at >> 8));
    spot.part[axis] = static_cast<uint8_t>(at);
  }
  return spot;
}

int16_t PeakMemory::height(const int16_t (&mm)[2]) const {
  const Spot here = spot(mm);
  const int16_t* south = heights_ + here.south_west;
  const int16_t* north = south + kSide;
  return between(between(south[0], south[1], here.part[kX]),
                 between(north[0], north[1], here.part[kX]), here.part[kY]);
}

void PeakMemory::learn(const LevelingInput& input) {
  int16_t uphill[2] = {input.pitch, input.roll};
  turn_vector(uphill, input.heading);  // from the robot's axes to east and north
  const Spot here = spot(input.place.mm);
  for (uint8_t axis = kX; axis <= kY; ++axis) {
    const uint8_t ahead = axis == kX ? 1 : kSide;
    const uint8_t aside = axis == kX ? kSide : 1;
    int16_t* h = heights_ + here.south_west;
    const uint8_t to_far = here.part[1 - axis];
    // From one height to the next, 1/32 mm: 2 half / (kSide - 1) times the slope, of which an angle
    // unit is 2 pi / 65536. 2 * 32 * 2 pi / 65536 = 1 / 163.
    const auto rise = static_cast<int16_t>(mul_i16(uphill[axis], site_.half_mm[axis]) /
                                           (163 * static_cast<int32_t>(kSide - 1)));
    const int16_t known = between(static_cast<int16_t>(h[ahead] - h[0]),
                                  static_cast<int16_t>(h[ahead + aside] - h[aside]), to_far);
    const auto step =
        static_cast<int16_t>(asr_round(mul_i16(static_cast<int16_t>(rise - known), kGain), 8));
    const int16_t far = scaled(step, to_far);
    const auto near = static_cast<int16_t>(step - far);
    h[0] = static_cast<int16_t>(h[0] - near);
    h[ahead] = static_cast<int16_t>(h[ahead] + near);
    h[aside] = static_cast<int16_t>(h[aside] - far);
    h[ahead + aside] = static_cast<int16_t>(h[ahead + aside] + far);
  }
}

void PeakMemory::choose_target() {
  ticks_left_ = kGiveUpTicks;
  int16_t highest = INT16_MIN;
  for (uint8_t tries = kChoice; tries > 0; --tries) {
    int16_t point[2];
    site_.draw_place(random_, kFromEdge_mm, point);
    const int16_t here = height(point);
    if (here <= highest) continue;
    highest = here;
    target_mm_[kX] = point[kX];
    target_mm_[kY] = point[kY];
  }
}

MotionCommand PeakMemory::tick(const LevelingInput& input, Behaviour& behaviour) {
  const LevelingState state = behaviour.state();
  if (ticks_left_ == 0 || (state != LevelingState::kSpin && state != LevelingState::kWalk)) {
    choose_target();
  } else if (state == LevelingState::kSpin) {
    --ticks_left_;
    const YawRate rate = yaw_rate_from_degrees(parameters_.spin_rate());
    return behaviour.enter_or_stay(LevelingState::kSpin,
                                   {0, spin_left_ ? rate : static_cast<YawRate>(-rate)});
  }
  --ticks_left_;
  if (++ticks_ >= kLearnTicks) {
    ticks_ = 0;
    learn(input);
  }
  const auto east = static_cast<int16_t>(target_mm_[kX] - input.place.mm[kX]);
  const auto north = static_cast<int16_t>(target_mm_[kY] - input.place.mm[kY]);
  if (abs_i16(east) < kArrived_mm && abs_i16(north) < kArrived_mm) {
    const int16_t ms = limit_i16(asr(mul_i16(height(input.place.mm), kDwell_ms_per_mm), 5),
                                 parameters_.spin_time());
    ticks_left_ = 0;
    if (ms >= kShortestSpin_ms) {
      ticks_left_ = ticks_from_ms(ms);
      spin_left_ = !spin_left_;
      return behaviour.enter_or_stay(LevelingState::kSpin, {0, 0});
    }
  }
  return behaviour.enter_or_stay(LevelingState::kWalk, behaviour.steer(east, north, input.heading));
}

}  // namespace screed
