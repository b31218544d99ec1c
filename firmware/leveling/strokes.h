// Strokes: on a slope the robot faces straight up or down it and drives to and fro so fast that its
// tracks slip; the ground goes downhill.
//
// Tracks that slip carry the layer below them along. Where a robot turns round faster than friction
// can turn it, it slips for a tenth of a second, until its body has followed. On a slope it does so
// at the lower end of a stroke, where gravity works against it, and hardly at the upper one, where
// gravity helps: so most of the slip is downhill, the more since the way down begins gently. The
// way up takes longer, by what the robot slides down on 10 degrees; gentler slopes it works its way
// up. A spin slips as much to all sides and carries a fifth of that (docs/studies/soil.md,
// Strokes).
//
// Where: it drives from one random place at the edge of its site to the next and works on every
// slope on its way that is worth it. What is worth it follows from what there is: the limit falls
// with every journey and rises with every work, so the steepest goes first.
#pragma once

#include "firmware/leveling/behaviour.h"
#include "firmware/leveling/site.h"
#include "firmware/math/random.h"

namespace screed {

class Strokes : public AlgorithmDefaults {
 public:
  explicit Strokes(const Parameters& parameters);
  void take(const Parameters& parameters) { keep(parameters_, parameters); }

  MotionCommand tick(const LevelingInput& input, Behaviour& behaviour);

  /// Slope from which on it works.
  Angle limit() const { return limit_; }

 private:
  enum class Phase : uint8_t { kTravel, kFace, kStroke };
  struct State {
    Angle pitch;  ///< with a lag
    Angle roll;
    uint16_t ticks_left;  ///< of the phase, at most
    int16_t target_mm[2];
    int16_t speed;  ///< uphill
    Phase phase;
    bool downhill;        ///< it faces downhill, else uphill
    uint8_t cycle_ticks;  ///< left of one way down and up
  };

  void begin(Phase phase, uint16_t ticks);
  void begin_cycle();
  void begin_journey();
  MotionCommand travel(const LevelingInput& input, Behaviour& behaviour);
  MotionCommand face(Behaviour& behaviour);
  MotionCommand stroke(Behaviour& behaviour);

  State state_{};
  Kept<Parameters> parameters_;
  Random random_;
  SiteRectangle site_;
  Angle limit_;
  uint8_t down_ticks_;
  uint8_t up_ticks_;
};

}  // namespace screed
