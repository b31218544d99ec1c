// Where the robot is on the plane, and how well it knows: dead reckoning from encoder counts and
// heading, corrected by position fixes and by walls that it touches.
//
// The heading comes from the attitude estimator, not from the difference of the tracks: skid
// steering makes the latter useless (thesis 4.3.1). Track travel is along the slope; its horizontal
// part counts, and of that the share that the tracks do not lose by slip.
//
// Each axis is a Kalman filter of one state. Slip makes the position drift like a random walk, so
// the variance grows with what the tracks travel and the robot does not, and with a 32nd of all
// travel, for what the share is wrong by and the heading:
//   variance += noise |travel| (1 - share + 1/32)
// and with a measurement z of the variance r
//   k = variance / (variance + r),  x += k (z - x),  variance -= k variance
// Between walls the place is projected onto what they allow, which can only bring it nearer to the
// truth (estimate projection: Simon, "Kalman filtering with state constraints: a survey of linear
// and nonlinear algorithms", IET Control Theory and Applications 4, 2010).
#pragma once

#include <stdint.h>

#include "firmware/estimation/place.h"
#include "firmware/math/fixed.h"
#include "firmware/math/trig.h"
#include "firmware/parameters/board_constants.h"
#include "firmware/parameters/parameters.h"

namespace screed {

class PositionEstimate {
 public:
  /// count_um_q4: track travel per encoder count, 1/16 um. noise: variance of the position that a
  /// metre of travel makes which is lost by slip, 125 mm^2; 0..1000.
  PositionEstimate(uint16_t count_um_q4, int16_t noise)
      : count_um_q4_(count_um_q4), noise_x4_(static_cast<uint16_t>(noise << 2)) {}

  /// At the origin for sure.
  void reset();

  /// One tick: counts of both tracks since the last tick (within kMaxTrackCounts), heading and
  /// pitch now; share: of the tracks' travel that moves the robot, 255: all of it.
  void update(int16_t counts_left, int16_t counts_right, Angle heading, Angle pitch, uint8_t share);

  /// No robot is beyond a wall: the place becomes the nearest within +-half_mm of the origin, east
  /// and north (two numbers), to 8 mm; below 8: no wall there. The variance stays.
  void keep_inside(const int16_t* half_mm);

  /// Measured along an axis: z_mm, +-sigma_mm (8..1000). False where that is further off than the
  /// root of `gate` standard deviations; 0: however far off it is. Then the position stays, and its
  /// variance grows by (256 mm)^2, since one of the two is wrong.
  SCREED_OUT_OF_LINE bool measure(uint8_t axis, int16_t z_mm, int16_t sigma_mm, uint8_t gate);

  /// Position and deviation now.
  SCREED_OUT_OF_LINE void get(Place& place) const;
  /// Along an axis, also beyond what a Place holds, mm. Wraps at +-262 m.
  int32_t mm(uint8_t axis) const { return asr(state_.place[axis], 13); }

 private:
  /// Zero after a reset.
  struct State {
    int32_t place[2];      ///< 2^-13 mm
    uint32_t variance[2];  ///< 16 mm^2, Q16: up to 724 mm of standard deviation
  };

  State state_{};
  uint16_t count_um_q4_;
  uint16_t noise_x4_;  ///< of 125 mm^2 a metre: 16 mm^2 for 128 mm
};

// The walls of the site: a rectangle whose sides run east and north about the origin, in which a
// robot that touches a wall learns where it is.

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
