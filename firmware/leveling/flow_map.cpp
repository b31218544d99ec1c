// Learns slopes and finds the flow that levels them.
#include "firmware/leveling/flow_map.h"

namespace screed {
namespace {

constexpr uint8_t kFeltLag = 4;      // of pitch and roll, 2^4 ticks
constexpr uint8_t kSlopeShift = 3;   // a cell takes over 2^-3 of what is new to it
constexpr int16_t kLevelShare = 64;  // and 2^-10 of the rest is the sensor's, which has 2^-16
constexpr uint8_t kSettleShift = 2;  // share of a difference that two cells exchange
constexpr uint8_t kSourceShift = 4;  // of a height, that adds to the potential in every sweep
constexpr uint8_t kFeltShift = 2;    // of the slope below the robot, that counts as flow
constexpr uint8_t kLearnMask = 7;    // it learns with every eighth cell

// Sums of 16 bits may wrap, on slopes that no robot can climb: without a sign that is defined.
int16_t sum(int16_t a, int16_t b) {
  return static_cast<int16_t>(static_cast<uint16_t>(a) + static_cast<uint16_t>(b));
}
int16_t difference(int16_t a, int16_t b) {
  return static_cast<int16_t>(static_cast<uint16_t>(a) - static_cast<uint16_t>(b));
}

/// Takes over 2^-shift of what is new; returns all of that.
SCREED_OUT_OF_LINE int16_t follow(int16_t& value, int16_t seen, uint8_t shift) {
  const int16_t news = difference(seen, value);
  value = sum(value, asr_i16(news, shift));
  return news;
}

/// Two values exchange a share of how much the second one is off its rise above the first.
SCREED_OUT_OF_LINE void exchange(int16_t& here, int16_t& there, int16_t rise) {
  const int16_t share = asr_i16(difference(difference(there, here), rise), kSettleShift);
  here = sum(here, share);
  there = difference(there, share);
}

}  // namespace

void FlowMap::tick(const LevelingInput& input, bool steady) {
  follow(felt_[0], input.pitch, kFeltLag);
  follow(felt_[1], input.roll, kFeltLag);
  if (steady && (next_ & kLearnMask) == 0) learn(input);
  relax();
}

SCREED_OUT_OF_LINE Angle FlowMap::uphill(uint8_t axis) const {
  return difference(felt_[axis], detail::high_half(level_[axis]));
}

uint8_t FlowMap::spot(const int16_t (&mm)[2], uint8_t (&at)[2]) const {
  for (uint8_t axis = kX; axis <= kY; ++axis) {
    const int16_t half = site_.half_mm[axis];
    const auto cell_mm = static_cast<uint16_t>(static_cast<uint16_t>(half) / (kSide / 2) + 1);
    at[axis] =
        static_cast<uint8_t>(static_cast<uint16_t>(limit_i16(mm[axis], half) + half) / cell_mm);
  }
  return static_cast<uint8_t>(at[kY] * kSide + at[kX]);
}

void FlowMap::learn(const LevelingInput& input) {
  int16_t off[2] = {uphill(0), uphill(1)};
  turn_vector(off, input.heading);
  uint8_t at[2];
  int16_t* known = cells_[spot(input.place.mm, at)].uphill;
  for (uint8_t axis = kX; axis <= kY; ++axis) {
    off[axis] = follow(known[axis], off[axis], kSlopeShift);
  }
  turn_vector_back(off, input.heading);
  for (uint8_t axis = kX; axis <= kY; ++axis) level_[axis] += mul_i16(off[axis], kLevelShare);
}

/// A cell and the next one along an axis.
SCREED_OUT_OF_LINE void FlowMap::settle(Cell* here, uint8_t axis) {
  Cell* there = here + (axis == kX ? 1 : kSide);
  exchange(here->height, there->height, asr_i16(sum(here->uphill[axis], there->uphill[axis]), 1));
  exchange(here->potential, there->potential, 0);
}

void FlowMap::relax() {
  Cell* here = cells_ + next_;
  here->potential = sum(here->potential, asr_i16(here->height, kSourceShift));
  if (++column_ != kSide) {
    settle(here, kX);
  } else {
    column_ = 0;
  }
  if (++next_ <= kSide * (kSide - 1)) {
    settle(here, kY);
  } else if (next_ == kSide * kSide) {
    next_ = 0;
  }
}

void FlowMap::source(const LevelingInput& input, int16_t (&from)[2]) const {
  uint8_t at[2];
  const Cell* here = cells_ + spot(input.place.mm, at);
  for (uint8_t axis = kX; axis <= kY; ++axis) {
    const uint8_t step = axis == kX ? 1 : kSide;
    const Cell* ahead = at[axis] == kSide - 1 ? here : here + step;
    const Cell* behind = at[axis] == 0 ? here : here - step;
    from[axis] = difference(ahead->potential, behind->potential);
  }
  turn_vector_back(from, input.heading);
  for (uint8_t axis = kX; axis <= kY; ++axis) {
    from[axis] = sum(from[axis], asr_i16(uphill(axis), kFeltShift));
  }
}

}  // namespace screed
