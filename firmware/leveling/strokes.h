// Strokes: the robot drives to and fro so fast that its tracks slip, and carries ground the way
// that levels its site.
//
// Tracks that slip carry the layer below them along. Where a robot turns round faster than friction
// can turn it, it slips for a tenth of a second, until its body has followed. A stroke that begins
// gently one way and hard the other slips at one of its ends only, and carries ground against the
// hard way; uphill that is, so that gravity helps. A spin slips as much to all sides and carries a
// fifth of that (docs/studies/soil.md, Strokes).
//
// Which way: where the map of flows (flow_map.h) wants ground to come from is the hard way. The
// robot faces it or turns its back on it, whichever is the shorter turn.
//
// Where: it drives from one random place at the edge of its site to the next and works wherever the
// flow is worth it. What is worth it follows from what there is: the limit falls with every journey
// and rises with every work, so the largest flow goes first. After a work it goes on ahead, so that
// works lie in a row and one hands on what the other brought.
#pragma once

#include "firmware/leveling/behaviour.h"
#include "firmware/leveling/flow_map.h"
#include "firmware/math/random.h"

namespace screed {

class Strokes : public AlgorithmDefaults {
 public:
  explicit Strokes(const Parameters& parameters);
  void take(const Parameters& parameters) { keep(parameters_, parameters); }

  MotionCommand tick(const LevelingInput& input, Behaviour& behaviour);

  /// Flow from which on it works, 1/16 of the map's unit.
  int16_t limit() const { return limit_; }
  const FlowMap& map() const { return map_; }

 private:
  enum class Phase : uint8_t { kTravel, kFace, kStroke, kAhead };
  struct State {
    int16_t flow;         ///< below the robot, as the map gives it
    int16_t from_ahead;   ///< of it, what has to come from ahead
    Angle direction;      ///< from where it has to come, left of ahead
    uint16_t ticks_left;  ///< of the phase, at most
    int16_t target_mm[2];
    int16_t speed;  ///< the hard way
    Phase phase;
    bool backwards;       ///< its back faces where ground comes from
    uint8_t cycle_ticks;  ///< left of one way to and fro
  };

  void look(const LevelingInput& input);
  void begin(Phase phase, uint16_t ticks);
  void begin_cycle();
  void begin_journey();
  MotionCommand travel(const LevelingInput& input, Behaviour& behaviour);
  MotionCommand face(Behaviour& behaviour);
  MotionCommand stroke(Behaviour& behaviour);
  MotionCommand ahead(const LevelingInput& input, Behaviour& behaviour);

  State state_{};
  Kept<Parameters> parameters_;
  Random random_;
  FlowMap map_;
  int16_t limit_;
};

}  // namespace screed
