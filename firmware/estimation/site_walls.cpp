// The walls of the site.
#include "firmware/estimation/site_walls.h"

#include "firmware/math/trig.h"

namespace screed {

bool touch_wall(const BoardConstants& board, const Parameters& parameters, Angle travel, bool felt,
                PositionEstimate& position) {
  // Quarters of a turn, their middles east, north, west and south.
  const auto quarter = static_cast<uint8_t>(static_cast<uint16_t>(travel + 8192) >> 14);
  const uint8_t axis = quarter & 1U;
  const int16_t half = axis == kX ? parameters.site_x() : parameters.site_y();
  if (half == 0) return false;
  auto place = static_cast<int16_t>(half - static_cast<int16_t>(board.hull_reach_mm));
  if (quarter >= 2) place = static_cast<int16_t>(-place);
  const bool west_of_it = static_cast<int16_t>(position.mm(axis)) < place;
  if (!felt && west_of_it == (quarter < 2)) return false;
  return position.measure(axis, place, kWallSigma_mm, 9);
}

}  // namespace screed
