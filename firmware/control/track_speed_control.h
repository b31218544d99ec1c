// Speed control of one track: encoder counts in, motor duty out.
//
// The encoder of the Rover 5 gives 1.8 counts a tick at 0.1 m/s, so the speed is observed by an
// alpha-beta tracking filter (critically damped, double pole at 0.837 a tick, 56 ms) instead of a
// difference of counts. The controller is PI with feed-forward from the motor's no-load speed,
// scaled by the battery voltage. The PI part compares the observed speed with the target as the
// same filter would show it: against the target itself the filter's delay would look like a track
// that lags, and every start would overshoot by half.
#pragma once

#include <stdint.h>

#include "firmware/control/kinematics.h"
#include "firmware/parameters/kept.h"
#include "firmware/parameters/own_board.h"
#include "firmware/parameters/parameters.h"

namespace screed {

class TrackSpeedControl : private OwnBoard {
 public:
  TrackSpeedControl(const BoardConstants& board, const Parameters& parameters);

  /// Live parameters (parameters.h), at any time.
  void take(const Parameters& parameters) { keep(parameters_, parameters); }

  /// One tick. target: track speed, mm/s; counts: encoder counts since the last tick; battery_mv:
  /// for the feed-forward. Returns the duty, -400..400. A target of 0 with the track at rest gives
  /// duty 0: the driver brakes.
  int16_t tick(int16_t target_mm_per_s, int16_t counts, uint16_t battery_mv);

  /// One tick with the motors off: observes the speed, forgets the controller's state.
  void release(int16_t counts);

  /// Observed speed, 0.1 mm/s.
  int16_t speed_dmm_per_s() const { return state_.motion.speed_dmm_per_s; }
  const TrackMotion& motion() const { return state_.motion; }

 private:
  /// What is forgotten with the motors off.
  struct Control {
    /// target behind one lag and behind two, as the observer would show it, 0.1 mm/s
    int32_t lagging_q4[2];
    int32_t integral_q16;  ///< duty
  };
  /// What the control of a track remembers, zero at the start: zeroed at once, which takes less
  /// flash.
  struct State {
    int32_t lag_q12;     ///< counts by which the observed position trails the encoder
    int32_t speed_q12;   ///< counts a tick
    TrackMotion motion;  ///< as others see it
    Control control;
  };

  /// Duty per mm/s at the nominal voltage.
  int16_t feed_forward_q8() const;
  void observe(int16_t counts);
  /// The target as the observer would show it, 0.1 mm/s.
  int32_t expect(int16_t target_mm_per_s);

  State state_{};
  Kept<Parameters> parameters_;
};

}  // namespace screed
