// A stretch of code that no interrupt comes into.
#pragma once

#include <avr/interrupt.h>
#include <avr/io.h>

namespace screed {
namespace avr {

/// Interrupts are off as long as it exists, and then as they were. Shorter than the loop that
/// ATOMIC_BLOCK of avr-libc is.
class InterruptsOff {
 public:
  __attribute__((always_inline)) InterruptsOff() { cli(); }
  __attribute__((always_inline)) ~InterruptsOff() {
    asm volatile("" : : : "memory");  // what was written is written before
    SREG = before_;
  }
  InterruptsOff(const InterruptsOff&) = delete;
  InterruptsOff& operator=(const InterruptsOff&) = delete;

 private:
  uint8_t before_ = SREG;
};

}  // namespace avr
}  // namespace screed
