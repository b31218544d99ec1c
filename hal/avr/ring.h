// A ring buffer of bytes between one interrupt and the main program. Each side writes one index
// only, and an index is one byte, so neither side needs to lock the other out.
#pragma once

#include <stdint.h>

namespace screed {
namespace avr {

template <uint8_t kSize>
class Ring {
  static_assert(kSize >= 2 && (kSize & (kSize - 1)) == 0,
                "the size must be a power of two, at most 128");

 public:
  uint8_t used() const { return static_cast<uint8_t>(put_ - got_); }
  uint8_t room() const { return static_cast<uint8_t>(kSize - used()); }
  /// Only with room() > 0.
  void put(uint8_t byte) {
    const uint8_t at = put_;
    bytes_[at & (kSize - 1)] = byte;
    put_ = static_cast<uint8_t>(at + 1);
  }
  /// Only with used() > 0.
  uint8_t get() {
    const uint8_t at = got_;
    const uint8_t byte = bytes_[at & (kSize - 1)];
    got_ = static_cast<uint8_t>(at + 1);
    return byte;
  }

 private:
  volatile uint8_t bytes_[kSize];
  volatile uint8_t put_;  // counts up for ever, modulo 256
  volatile uint8_t got_;
};

}  // namespace avr
}  // namespace screed
