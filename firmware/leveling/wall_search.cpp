// Seeks a wall.
#include "firmware/leveling/wall_search.h"

namespace screed {
namespace {

constexpr int16_t kFarAway_mm = 1000;  // in that direction: any distance does

}  // namespace

WallSearch::WallSearch(const Parameters& parameters)
    : limit_(parameters.lost_sigma == 0
                 ? static_cast<uint8_t>(UINT8_MAX)
                 : static_cast<uint8_t>(static_cast<uint16_t>(parameters.lost_sigma) >> 2)),
      seeks_{parameters.lost_action != 0 && parameters.site_x != 0,
             parameters.lost_action != 0 && parameters.site_y != 0} {}

bool WallSearch::update(const Place& place) {
  const uint8_t axis = place.sigma[kY] > place.sigma[kX] ? kY : kX;
  lost_ = place.sigma[axis] > (lost_ ? static_cast<uint8_t>(limit_ >> 1) : limit_);
  gave_up_ = lost_ && !seeks_[axis];
  if (!lost_ || gave_up_) return false;
  towards_[1 - axis] = 0;
  towards_[axis] = place.mm[axis] < 0 ? -kFarAway_mm : kFarAway_mm;
  return true;
}

}  // namespace screed
