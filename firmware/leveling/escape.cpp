// A bounded manoeuvre out of where the robot is stuck.
#include "firmware/leveling/escape.h"

#include "firmware/math/units.h"
#include "hal/program_memory.h"
#include "hal/sample.h"

namespace screed {
namespace {

constexpr uint8_t kTimeTicks = 4;  // unit of a step's time: 40 ms

constexpr uint8_t speed(int16_t mm_per_s) {
  return static_cast<uint8_t>(mm_per_s / 10);
}
constexpr uint8_t turn(int16_t deg_per_s) {
  return static_cast<uint8_t>(deg_per_s);
}
constexpr uint8_t time(int16_t ms) {
  return static_cast<uint8_t>(ms / (10 * kTimeTicks));
}

// A way to come loose: two steps in turn, each a speed, a turn and a time, and how often. The turns
// are those of the first attempt and every second one after it, the others turn the other way.
constexpr uint8_t kStepBytes = 3;
constexpr uint8_t kWayBytes = 2 * kStepBytes + 1;
const uint8_t kWays[][kWayBytes] SCREED_PROGRAM_MEMORY = {
    {speed(-200), turn(0), time(1500), speed(0), turn(60), time(1500), 1},     // back, turn away
    {speed(-250), turn(0), time(480), speed(250), turn(0), time(480), 8},      // rock
    {speed(-100), turn(60), time(480), speed(-100), turn(-60), time(480), 4},  // alternate tracks
    {speed(-250), turn(0), time(800), speed(250), turn(0), time(800), 5},      // rock slowly
};
constexpr uint8_t kWayCount = sizeof(kWays) / kWayBytes;

// A report of being stuck that is older than the step has ended by then.
constexpr uint8_t kSettleTicks = 100;
// A robot that has been free for so long got out.
constexpr uint16_t kFreeTicks = 10 * kTickRate_hz;

}  // namespace

void Escape::start() {
  ticks_ = 0;
  attempt_ = 0;
  steps_left_ = 0;
  gave_up_ = false;
}

uint8_t Escape::value(uint8_t index) const {
  return read_program_u8(&kWays[way_][(steps_left_ & 1U) != 0 ? index + kStepBytes : index]);
}

void Escape::begin(uint8_t way) {
  way_ = way;
  ticks_ = 0;
  steps_left_ = static_cast<uint8_t>(2 * read_program_u8(&kWays[way][kWayBytes - 1]));
}

bool Escape::tick(bool stuck) {
  if (ticks_ < kFreeTicks) ++ticks_;
  gave_up_ = false;
  if (steps_left_ == 0) {
    if (!stuck) {
      if (ticks_ == kFreeTicks) attempt_ = 0;
      return false;
    }
    gave_up_ = attempt_ == attempts_ && attempts_ != 0;
    if (attempt_ == attempts_) return false;
    begin(attempt_ % kWayCount);
    ++attempt_;
    return true;
  }
  const auto duration = static_cast<uint16_t>(value(2) * kTimeTicks);
  if (ticks_ < duration && (!stuck || ticks_ < kSettleTicks)) return true;
  ticks_ = 0;
  --steps_left_;
  // Loose, perhaps: out of there.
  if (steps_left_ == 0 && way_ != 0) begin(0);
  return steps_left_ != 0;
}

MotionCommand Escape::motion() const {
  const YawRate rate = yaw_rate_from_degrees(static_cast<int8_t>(value(1)));
  return {static_cast<int16_t>(static_cast<int8_t>(value(0)) * 10),
          (attempt_ & 1U) != 0 ? rate : static_cast<YawRate>(-rate)};
}

}  // namespace screed
