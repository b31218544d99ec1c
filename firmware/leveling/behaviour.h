// What the leveling algorithms have in common: what they see, the states they may be in, the random
// walk, the climb and the way back to the site.
//
// The algorithms level with the robot's own motion alone (thesis 7.1.1): they seek hills and drive
// over them. They see attitude and dead reckoning, no map, and answer with a commanded body motion.
//
// An algorithm is a value of LEVELING.algorithm in screed.dbc, say `dig_holes`, and the class of
// that name, DigHoles, in firmware/leveling/dig_holes.h:
//
//   class DigHoles : public AlgorithmDefaults {
//    public:
//     explicit DigHoles(const Parameters& parameters);
//     MotionCommand tick(const LevelingInput& input, Behaviour& behaviour);
//   };
//
// The constructor runs at power-up and whenever a parameter was changed, on a robot at rest; what
// the object holds then begins anew. One object of every algorithm of the image lies in Leveling
// for good: no heap, no virtual functions. tick() runs 100 times a second while the robot runs, and
// ends with one of the motions of Behaviour or with enter_or_stay(): the state it enters is what
// the robot reports and records. Its time counts against the tick's (make size), and it waits for
// nothing.
#pragma once

#include <stdint.h>

#include "firmware/control/kinematics.h"
#include "firmware/estimation/place.h"
#include "firmware/leveling/site.h"
#include "firmware/leveling/walk_legs.h"
#include "firmware/parameters/kept.h"
#include "firmware/parameters/parameters.h"
#include "schema/values.h"

namespace screed {

/// Names and numbers come from the schema: screed.dbc.
using LevelingAlgorithm = message::LevelingAlgorithm;
using LevelingState = message::LevelingState;

/// What an algorithm sees.
struct LevelingInput {
  Angle pitch;    ///< nose up positive
  Angle heading;  ///< counter-clockwise from east
  Place place;
  MotionCommand drive;     ///< what the ground station commands
  Angle roll = 0;          ///< left side up positive; with the pitch the direction of the slope
  bool backwards = false;  ///< it was told to drive so in the tick before
  bool stuck = false;      ///< the tracks turn and the robot does not move (slip_watch.h)
};

/// What holds for an algorithm that does not say otherwise.
struct AlgorithmDefaults {
  /// Outside the site the robot drives back, unless it spins, and a stuck robot gets itself out
  /// (escape.h); the algorithm is not asked meanwhile.
  static constexpr bool kKeepsToSite = true;
  /// Live parameters (parameters.h) that it keeps.
  void take(const Parameters& /*parameters*/) {}
};

class Behaviour {
 public:
  explicit Behaviour(const Parameters& parameters);

  LevelingState state() const { return state_; }
  /// Ticks spent in this state, before the current one, since it was entered or restart_time().
  uint16_t ticks_in_state() const { return ticks_in_state_; }
  void restart_time() { ticks_in_state_ = 0; }
  /// Climbs that ended in another motion than the return to the site or the escape. Starts at 0
  /// again after a parameter change; a climb cut off by a stop does not count.
  uint16_t peaks() const { return peaks_; }

  // Walk and climb go forwards or backwards: a robot that backed in at the fence, where a turn
  // would dig in, goes on backwards until it drives in forwards. Up and down are seen that way.

  /// The way ahead is an incline worth climbing. A climb goes on until the pitch has fallen below
  /// the threshold by the hysteresis.
  bool uphill(const LevelingInput& input) const;
  /// The way ahead is a decline.
  bool downhill(const LevelingInput& input) const {
    return ahead(input.pitch) < static_cast<Angle>(-hysteresis());
  }

  /// A leg of the random walk; a new one where the walk begins.
  MotionCommand walk();
  /// Straight on, as Algorithm 6. With the parameter climb_turn, on an incline: towards the
  /// steepest ascent that pitch and roll show.
  SCREED_OUT_OF_LINE MotionCommand climb(const LevelingInput& input);
  /// Towards the point that lies so far east and north of the robot, backwards where it lies
  /// behind; turns on the spot while it lies aside.
  MotionCommand steer(int16_t east_mm, int16_t north_mm, Angle heading) const {
    return fence_.steer(east_mm, north_mm, heading);
  }
  /// Any other motion, in a state of its own.
  MotionCommand enter_or_stay(LevelingState state, MotionCommand motion);

  // For Leveling.
  void take(const Parameters& parameters) {
    keep(parameters_, parameters);
    walk_.take(parameters);
    fence_.take(parameters);
  }
  /// The state begins anew: a run starts.
  void start();
  /// Returns true while the robot has to drive back to its site, by `motion`: outside, unless it
  /// drives inwards already. Then walk and climb go on in the direction in which it came back.
  bool return_to_site(const LevelingInput& input, MotionCommand& motion);
  /// It is outside the site, on its way back or not.
  bool outside() const { return fence_.outside(); }

 private:
  /// Counts the tick in its state, and begins the state where it is another than in the tick
  /// before.
  void enter_or_stay(LevelingState next);

  /// Of a pitch or roll: as it is for a robot that faces where it goes.
  SCREED_OUT_OF_LINE Angle ahead(Angle angle) const;
  /// A motion, that way.
  MotionCommand motion_ahead(MotionCommand motion) const;
  Angle hysteresis() const { return angle_from_centidegrees(parameters_.climb_hysteresis()); }

  Kept<Parameters> parameters_;
  WalkLegs walk_;
  SiteFence fence_;
  LevelingState state_ = LevelingState::kIdle;
  uint16_t ticks_in_state_ = 0;
  uint16_t peaks_ = 0;
  bool backwards_ = false;  ///< walk and climb go so
};

}  // namespace screed
