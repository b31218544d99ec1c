// The walls of the site.
#include "firmware/estimation/site_walls.h"

#include "firmware/math/trig.h"

namespace screed {

bool SiteWalls::touch(Angle travel, PositionEstimate& position) const {
  const int16_t east = cos_q15(travel);
  const int16_t north = sin_q15(travel);
  const uint8_t axis = abs_i16(north) > abs_i16(east) ? 1 : 0;
  const int16_t towards = axis == 0 ? east : north;
  const int16_t half = half_mm_[axis];
  if (half == 0) return false;
  auto place = static_cast<int16_t>(half - reach_mm_);
  if (towards < 0) place = static_cast<int16_t>(-place);
  return position.measure(axis, place, kSigma_mm);
}

}  // namespace screed
