// The walls of the site.
#include "firmware/estimation/site_walls.h"

#include "firmware/math/trig.h"

namespace screed {
namespace {

// A wall that the robot travels along within 20 degrees is not what stopped it: sin 20, Q15.
constexpr int16_t kAlongside_q15 = 11207;

}  // namespace

bool SiteWalls::touch(Angle travel, PositionEstimate& position) const {
  const int16_t towards[2] = {cos_q15(travel), sin_q15(travel)};
  int16_t best_place = 0;
  uint16_t best_error = UINT16_MAX;
  uint8_t best_axis = 0;
  for (uint8_t axis = 0; axis < 2; ++axis) {
    if (half_mm_[axis] == 0 || abs_i16(towards[axis]) < kAlongside_q15) continue;
    auto place = static_cast<int16_t>(half_mm_[axis] - reach_mm_);
    if (towards[axis] < 0) place = static_cast<int16_t>(-place);
    const uint16_t error = abs_i16(limit_i16(place - position.mm(axis), INT16_MAX));
    if (error >= best_error) continue;
    best_error = error;
    best_place = place;
    best_axis = axis;
  }
  return best_error != UINT16_MAX && position.measure(best_axis, best_place, kSigma_mm);
}

}  // namespace screed
