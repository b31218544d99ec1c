// The walls of the site: a rectangle whose sides run east and north about the origin, in which a
// robot that touches a wall learns where it is.
#pragma once

#include <stdint.h>

#include "firmware/estimation/position_estimate.h"
#include "firmware/parameters/board_constants.h"
#include "firmware/parameters/parameters.h"

namespace screed {

/// Standard deviation of a place that a wall tells: hull, angle, piles before it.
constexpr uint8_t kWallSigma_mm = 40;

/// The robot is stuck; `travel`: where to, counter-clockwise from east; `felt`: by a collision. It
/// is at the wall that it travels to most directly, also without a collision where it believes to
/// be at that wall or beyond: loose ground piles up before a wall and softens the blow. False where
/// there is none (site_x, site_y), or it cannot be there: more than 3 standard deviations off. Then
/// the place is not changed, but its variance grows: where blow follows blow the next is believed
/// from farther off.
bool touch_wall(const BoardConstants& board, const Parameters& parameters, Angle travel, bool felt,
                PositionEstimate& position);

}  // namespace screed
