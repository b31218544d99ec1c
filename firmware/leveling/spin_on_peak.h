// Algorithm 6's successor (thesis 7.1.1): "An approach ... could continue on a straight path when
// an incline is detected, but instead begin a spinning maneuver once a decline is detected".
// Between incline and decline the path goes on straight.
#pragma once

#include "firmware/leveling/behaviour.h"

namespace screed {

class SpinOnPeak : public AlgorithmDefaults {
 public:
  explicit SpinOnPeak(const Parameters& parameters);

  MotionCommand tick(const LevelingInput& input, Behaviour& behaviour);

 private:
  MotionCommand spin(Behaviour& behaviour) const;

  YawRate spin_rate_;
  uint16_t spin_ticks_;
  /// The next spin turns left: alternating, so that heading errors do not add up.
  bool spin_left_ = true;
};

}  // namespace screed
