// Gets a stuck robot out: a bounded manoeuvre, then it gives up.
//
// The robot is stuck when the slip watch says so. Each such report is an attempt. The first goes
// back, since what lies there was passable, and turns away, so that the algorithm goes on
// elsewhere. The next ones rock or alternate the tracks before that; left and right in turn. For a
// robot that drove backwards all of it is mirrored. Outside its site it goes half as far, and all
// attempts but the first kind lead on instead of back, since it drives inwards there. Each
// attempt ends with the tracks at rest: then the slip watch forgets what was. A robot that is free
// for 10 s has all attempts again; one that is stuck after the last has given up.
//
// It commands motions as an algorithm does: the supervisor's protection of the tracks holds.
#pragma once

#include <stdint.h>

#include "firmware/control/kinematics.h"
#include "firmware/parameters/parameters.h"

namespace screed {

class Escape {
 public:
  explicit Escape(const Parameters& parameters)
      : attempts_(static_cast<uint8_t>(parameters.escape_attempts())) {}

  /// A run begins: all attempts are left.
  void start();

  /// One tick of a robot that runs. Returns true while the manoeuvre drives, with motion().
  /// backwards: the way out lies ahead, as of a robot that drove so before; outside: of its site.
  SCREED_OUT_OF_LINE bool tick(bool stuck, bool backwards = false, bool outside = false);
  const MotionCommand& motion() const { return state_.motion; }
  /// Stuck, and no attempt is left: in this tick.
  bool gave_up() const { return state_.gave_up; }

 private:
  /// The next step of the way, or the first one of the next way.
  void begin_step(uint8_t next_way);

  /// Zero at the start, and zeroed at once, which takes less flash.
  struct State {
    MotionCommand motion;
    uint16_t ticks_left;  ///< of the step; of the time in which the attempts count
    uint8_t attempt;      ///< how many were begun since the robot was free for long
    uint8_t way;          ///< to come loose
    uint8_t steps_left;   ///< of that way; 0: does not drive
    bool mirrored;        ///< the way out lies ahead
    bool outside;         ///< it drove back to its site
    bool gave_up;
  };

  uint8_t attempts_;  ///< 0: no escape
  State state_{};
};

}  // namespace screed
