// The three LEDs of the board.
#pragma once

#include <stdint.h>

namespace screed {
namespace avr {

void leds_init();

/// LedBit set.
void leds_write(uint8_t leds);

}  // namespace avr
}  // namespace screed
