// The sparse samples that an agent judges heights by: a FIFO of the last few, whose mean is the
// alpha of Algorithm 1. Comparisons with the mean are exact: h n against the sum, no division.
#pragma once

#include <stdint.h>

namespace screed {

class HeightMemory {
 public:
  static constexpr uint8_t kMaxLength = 8;

  /// length: samples kept, 1..kMaxLength.
  explicit HeightMemory(uint8_t length = kMaxLength) : length_(length) {}

  /// Forgets the oldest sample when there are `length` already.
  void add(uint16_t height);

  /// No sample yet: nothing is above or below.
  bool empty() const { return count_ == 0; }
  bool is_above(uint16_t height) const { return static_cast<uint32_t>(height) * count_ > sum_; }
  bool is_below(uint16_t height) const { return static_cast<uint32_t>(height) * count_ < sum_; }

  /// Sum and number of the samples kept.
  uint32_t sum() const { return sum_; }
  uint8_t count() const { return count_; }

 private:
  uint32_t sum_ = 0;
  uint16_t samples_[kMaxLength] = {};
  uint8_t length_;
  uint8_t count_ = 0;
  uint8_t oldest_ = 0;  ///< where the next sample goes
};

}  // namespace screed
