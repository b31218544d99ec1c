// Coverage in parallel lines.
#include "firmware/leveling/coverage.h"

namespace screed {
namespace {

// Of the point the robot steers for. Short, so that it changes to the next line near the edge; the
// line is met with a damping of 0.5 at 160 mm/s.
constexpr int16_t kLookAhead_mm = 80;

}  // namespace

void Coverage::next_line() {
  west_ = !west_;
  auto next = static_cast<int16_t>(line_mm_ + step_mm_);
  if (abs_i16(next) > static_cast<uint16_t>(half_side_mm_)) {
    step_mm_ = static_cast<int16_t>(-step_mm_);
    next = static_cast<int16_t>(line_mm_ + step_mm_);
  }
  // One line alone where the square is no wider than the spacing.
  if (abs_i16(next) <= static_cast<uint16_t>(half_side_mm_)) line_mm_ = next;
}

MotionCommand Coverage::tick(const LevelingInput& input, Behaviour& behaviour) {
  const LevelingState state = behaviour.state();
  if ((west_ ? -input.place.mm[kX] : input.place.mm[kX]) > half_side_mm_ ||
      state == LevelingState::kReturn || state == LevelingState::kEscape) {
    next_line();
  }
  const int16_t ahead = west_ ? static_cast<int16_t>(-kLookAhead_mm) : kLookAhead_mm;
  return behaviour.enter_or_stay(
      LevelingState::kCover,
      behaviour.steer(ahead,
                      limit_i16(static_cast<int32_t>(line_mm_) - input.place.mm[kY], INT16_MAX),
                      input.heading));
}

}  // namespace screed
