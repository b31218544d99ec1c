// The drive that training data is recorded on (thesis Algorithm 5): eight blocks of equal length,
// each a combination of forward, backward, left and right; every 250 ticks a new share of full
// speed is drawn.
//
// It levels nothing and looks at nothing: it covers the range of motor speeds evenly. A run of n
// frames is given as the length of a block, n / 8.
#pragma once

#include <stdint.h>

#include "firmware/leveling/behaviour.h"
#include "firmware/math/random.h"

namespace screed {

class TrainingDrive : public AlgorithmDefaults {
 public:
  static constexpr bool kKeepsToSite = false;
  static constexpr uint8_t kBlocks = 8;
  static constexpr uint8_t kSegmentTicks = 250;
  /// 3 thesis units/s at 1/12 m a unit, and pi/2 rad/s.
  static constexpr int16_t kFullSpeed_mm_per_s = 250;
  static constexpr YawRate kFullYawRate = 16384;

  explicit TrainingDrive(const Parameters& parameters);

  /// One tick: state kTrainingDrive, kDone and standstill once all blocks are driven.
  MotionCommand tick(const LevelingInput& input, Behaviour& behaviour);
  /// The drive alone: the desired motion of one tick.
  MotionCommand tick();

  /// All blocks are driven.
  bool finished() const { return block_ == kBlocks; }

 private:
  uint16_t length_of(uint8_t block) const;

  Random random_;
  uint16_t block_ticks_;
  uint16_t ticks_left_ = 0;  ///< of the block
  uint8_t segment_left_ = 0;
  uint8_t block_ = 0;
  int16_t share_q15_ = 0;  ///< the r of Algorithm 5
};

}  // namespace screed
