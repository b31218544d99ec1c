// A bounded manoeuvre out of where the robot is stuck.
#include "firmware/leveling/escape.h"

#include "firmware/math/units.h"
#include "hal/program_memory.h"
#include "hal/sample.h"

namespace screed {
namespace {

// Units of a step, chosen so that its numbers fit a byte and are shifts away from those of a
// motion.
constexpr uint8_t speed(int16_t mm_per_s) {
  return static_cast<uint8_t>(mm_per_s / 2);
}
constexpr uint8_t turn(int16_t deg_per_s) {
  return static_cast<uint8_t>(deg_per_s * 256 / 360);
}
constexpr uint8_t time(int16_t ms) {
  return static_cast<uint8_t>(ms / 40);
}

// A way to come loose: two steps in turn, each a speed, a turn and a time; how many steps. The
// turns are those of the first attempt and every second one after it, the others turn the other
// way.
constexpr uint8_t kStepBytes = 3;
constexpr uint8_t kWayBytes = 2 * kStepBytes + 1;
const uint8_t kWays[][kWayBytes] SCREED_PROGRAM_MEMORY = {
    {speed(-200), turn(0), time(1480), speed(0), turn(60), time(1480), 2},     // back, turn away
    {speed(-250), turn(0), time(480), speed(250), turn(0), time(480), 16},     // rock
    {speed(-100), turn(60), time(480), speed(-100), turn(-60), time(480), 8},  // alternate tracks
    {speed(-250), turn(0), time(800), speed(250), turn(0), time(800), 10},     // rock slowly
    {0, 0, 0, speed(0), turn(0), time(400), 1},  // stand: the slip watch begins anew
};
constexpr uint8_t kStand = sizeof(kWays) / kWayBytes - 1;
constexpr uint8_t kLastWay = kStand - 1;
static_assert((kLastWay & (kLastWay + 1)) == 0, "the ways begin again by a mask");

// A robot that has been free for so long got out.
constexpr uint16_t kFreeTicks = 10 * kTickRate_hz;

}  // namespace

SCREED_OUT_OF_LINE void Escape::start() {
  state_ = {};
}

void Escape::begin_step(uint8_t next_way) {
  const bool new_way = state_.steps_left == 0;
  if (new_way) state_.way = next_way;
  const uint8_t* step = kWays[state_.way];
  if (new_way) state_.steps_left = read_program_u8(step + kWayBytes - 1);
  if ((state_.steps_left & 1U) != 0) step += kStepBytes;
  auto speed = static_cast<int8_t>(read_program_u8(step));
  if (state_.mirrored) speed = static_cast<int8_t>(-speed);
  state_.motion.speed_mm_per_s = static_cast<int16_t>(2 * speed);
  uint8_t turn = read_program_u8(step + 1);
  if ((state_.attempt & 1U) == 0) turn = static_cast<uint8_t>(-turn);
  state_.motion.yaw_rate = static_cast<YawRate>(static_cast<int8_t>(turn) * 256);
  uint8_t time = read_program_u8(step + 2);
  // Outside a robot that is stuck again and again would get farther away, and turned by more than
  // 45 degrees it would turn back on the spot (site.cpp) and dig in there.
  if (state_.outside && state_.way == 0) time = static_cast<uint8_t>(time >> 1);
  state_.ticks_left = static_cast<uint16_t>(time * 4U);
}

bool Escape::tick(bool stuck, bool backwards, bool outside) {
  state_.gave_up = false;
  if (state_.ticks_left != 0) --state_.ticks_left;
  uint8_t next_way = 0;  // loose, perhaps: out of there
  if (state_.steps_left == 0) {
    if (!stuck) {
      if (state_.ticks_left == 0) state_.attempt = 0;
      return false;
    }
    if (state_.attempt == attempts_) {
      state_.gave_up = attempts_ != 0;
      return false;
    }
    next_way = state_.attempt & kLastWay;
    // Outside it backs off once. What else it tries leads on, inwards.
    state_.mirrored = backwards != (outside && next_way != 0);
    state_.outside = outside;
    ++state_.attempt;
  } else {
    if (state_.ticks_left != 0) return true;
    --state_.steps_left;
    if (state_.way == 0) next_way = kStand;
    if (state_.steps_left == 0 && state_.way == kStand) {
      state_.ticks_left = kFreeTicks;
      return false;
    }
  }
  begin_step(next_way);
  return true;
}

}  // namespace screed
