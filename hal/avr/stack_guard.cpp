// The stack, watched while the program runs.
#include "hal/avr/stack_guard.h"

#include <avr/io.h>

// Set by the linker: the first byte behind the variables.
extern "C" uint8_t __heap_start;

namespace screed {
namespace avr {
namespace {

constexpr uint8_t kPaint = 0xA5;
constexpr uint8_t kCanaryBytes = 4;
constexpr uint8_t kBytesPerStep = 8;

struct State {
  uint16_t at;  // bytes behind the variables that are known to be painted
  uint16_t free;
};
State state;

}  // namespace

/// Paints all RAM above the variables. The stack pointer stands at the end of RAM, and nothing is
/// on the stack yet.
extern "C" void screed_paint_stack() __attribute__((naked, used, section(".init3")));
extern "C" void screed_paint_stack() {
  asm volatile(
      "ldi r30, lo8(__heap_start)\n\t"
      "ldi r31, hi8(__heap_start)\n\t"
      "ldi r24, %[paint]\n\t"
      "ldi r25, hi8(%[end])\n"
      "1:\n\t"
      "st Z+, r24\n\t"
      "cpi r30, lo8(%[end])\n\t"
      "cpc r31, r25\n\t"
      "brlo 1b\n\t"
      :
      : [paint] "i"(kPaint), [end] "i"(RAMEND + 1)
      : "r24", "r25", "r30", "r31", "memory");
}

bool stack_intact() {
  const uint8_t* const canary = &__heap_start;
  for (uint8_t i = 0; i < kCanaryBytes; ++i) {
    if (canary[i] != kPaint) return false;
  }
  return true;
}

void stack_guard_step() {
  for (uint8_t i = 0; i < kBytesPerStep; ++i) {
    if ((&__heap_start)[state.at] != kPaint) {
      state.free = state.at;
      state.at = 0;
      return;
    }
    ++state.at;
  }
}

uint16_t stack_free() {
  return state.free;
}

}  // namespace avr
}  // namespace screed
