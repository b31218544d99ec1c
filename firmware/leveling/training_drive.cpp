// Algorithm 5 of the thesis.
#include "firmware/leveling/training_drive.h"

namespace screed {
namespace {

constexpr int16_t kMinShare_q15 = 8192;  // 0.25
constexpr int16_t kMaxShare_q15 = 32767;

// Signs of l and omega in the eight blocks: those of the printed algorithm (the text beside it
// turns the third block the other way and lets it drive).
constexpr int8_t kDirections[TrainingDrive::kBlocks][2] = {{1, 0}, {-1, 0},  {0, 1},  {0, -1},
                                                           {1, 1}, {-1, -1}, {-1, 1}, {1, -1}};

/// As fast backward as forward: the sign comes after the rounding.
int16_t scaled(int16_t full, int8_t direction, int16_t share_q15) {
  const int32_t size = asr(static_cast<int32_t>(full) * share_q15, 15);
  return static_cast<int16_t>(direction * size);
}

}  // namespace

TrainingDrive::TrainingDrive(const Parameters& parameters)
    : random_(static_cast<uint16_t>(parameters.random_seed())),
      block_ticks_(static_cast<uint16_t>(parameters.training_block())),
      ticks_left_(length_of(0)) {}

// As printed: the first block has i <= n/8, so it takes one frame from the second.
uint16_t TrainingDrive::length_of(uint8_t block) const {
  if (block == 0) return static_cast<uint16_t>(block_ticks_ + 1U);
  if (block == 1) return static_cast<uint16_t>(block_ticks_ - 1U);
  return block_ticks_;
}

MotionCommand TrainingDrive::tick(const LevelingInput& /*input*/, Behaviour& behaviour) {
  const MotionCommand motion = tick();
  return behaviour.enter_or_stay(finished() ? LevelingState::kDone : LevelingState::kTrainingDrive,
                                 motion);
}

MotionCommand TrainingDrive::tick() {
  while (!finished() && ticks_left_ == 0) ticks_left_ = length_of(++block_);
  if (finished()) return {0, 0};
  --ticks_left_;
  if (segment_left_ == 0) {
    segment_left_ = kSegmentTicks;
    share_q15_ = random_.uniform(kMinShare_q15, kMaxShare_q15);
  }
  --segment_left_;
  const int8_t* direction = kDirections[block_];
  return {scaled(kFullSpeed_mm_per_s, direction[0], share_q15_),
          scaled(kFullYawRate, direction[1], share_q15_)};
}

}  // namespace screed
