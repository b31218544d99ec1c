// Seeks a wall.
#include "firmware/leveling/wall_search.h"

namespace screed {
namespace {

constexpr int16_t kFarAway_mm = 1000;  // in that direction: any distance does

}  // namespace

bool WallSearch::update(const Place& place) {
  const uint8_t axis = place.sigma[kY] > place.sigma[kX] ? kY : kX;
  // In units of 4 mm, 175 at most. A robot without a limit is never lost.
  auto limit = static_cast<uint8_t>(static_cast<uint16_t>(parameters_.lost_sigma()) >> 2);
  if (parameters_.lost_sigma() == 0) limit = UINT8_MAX;
  if (lost_) limit = static_cast<uint8_t>(limit >> 1);
  lost_ = place.sigma[axis] > limit;
  gave_up_ = false;
  if (!lost_) return false;
  if (parameters_.lost_action() == 0 || walls()[axis] == 0) {
    gave_up_ = true;
    return false;
  }
  towards_[kX] = 0;
  towards_[kY] = 0;
  towards_[axis] = place.mm[axis] < 0 ? -kFarAway_mm : kFarAway_mm;
  return true;
}

}  // namespace screed
