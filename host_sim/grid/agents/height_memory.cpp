// The FIFO of sensed heights.
#include "host_sim/grid/agents/height_memory.h"

namespace screed {

void HeightMemory::add(uint16_t height) {
  if (count_ == length_) {
    sum_ -= samples_[oldest_];
  } else {
    ++count_;
  }
  samples_[oldest_] = height;
  sum_ += height;
  oldest_ = oldest_ + 1 == length_ ? static_cast<uint8_t>(0) : static_cast<uint8_t>(oldest_ + 1);
}

}  // namespace screed
