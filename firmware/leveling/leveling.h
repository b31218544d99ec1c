// What every leveling algorithm sees and answers, and the one place that knows which algorithms
// there are.
//
// The algorithms level with the robot's own motion alone (thesis 7.1.1): they seek hills and drive
// over them. They see attitude and dead reckoning, no map, and answer with a commanded body motion.
// A new algorithm is a new file, a value of LevelingAlgorithm and a case in leveling.cpp.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "firmware/control/kinematics.h"
#include "firmware/leveling/random_walk.h"
#include "firmware/leveling/site_fence.h"
#include "firmware/leveling/training_drive.h"
#include "firmware/parameters/parameters.h"
#include "schema/values.h"

namespace screed {

struct LevelingInput {
  Angle pitch;    ///< nose up positive
  Angle heading;  ///< counter-clockwise from east
  int32_t x_mm;   ///< dead reckoning from the start of the run
  int32_t y_mm;
};

/// Names and numbers come from the schema: screed.dbc.
using LevelingAlgorithm = message::LevelingAlgorithm;
using LevelingState = message::LevelingState;

class Leveling {
 public:
  explicit Leveling(const Parameters& parameters);

  /// Builds one anew in its place. Assigned, it would be built in the main loop's stack frame
  /// first, and what lies there beyond 63 bytes costs flash wherever it is used.
  static void* operator new(size_t /*size*/, void* place) noexcept { return place; }

  /// Starts a run: the state begins anew. Random sequence, fence, the side of the next spin and
  /// what is left of a training drive go on.
  void start();

  /// One tick of the selected algorithm. `drive` is what the ground station commands, used by
  /// kDrive alone.
  MotionCommand tick(const LevelingInput& input, const MotionCommand& drive);

  LevelingAlgorithm algorithm() const { return algorithm_; }
  LevelingState state() const { return state_; }
  /// Peaks met since power-up: climbs that ended.
  uint16_t peaks() const { return peaks_; }

 private:
  LevelingState next_hill_sensing(Angle pitch) const;
  LevelingState next_spin_on_peak(Angle pitch);
  MotionCommand motion();
  void enter(LevelingState next);

  LevelingAlgorithm algorithm_;
  Angle threshold_;
  Angle hysteresis_;
  int16_t climb_speed_;
  YawRate spin_rate_;
  uint16_t spin_ticks_;
  RandomWalk walk_;
  SiteFence fence_;
#if SCREED_TRAINING_DRIVE
  TrainingDrive training_;
#endif
  LevelingState state_ = LevelingState::kIdle;
  uint16_t ticks_in_state_ = 0;  ///< this one included; in a climb since the last incline
  uint16_t peaks_ = 0;
  bool spin_left_ =
      true;  ///< the next spin turns left: alternating, so that heading errors do not add up
};

}  // namespace screed
