// The three LEDs of the board.
#include "hal/avr/leds.h"

#include "hal/sample.h"
#include "pins.h"

namespace screed {
namespace avr {

void leds_write(uint8_t leds) {
  YellowLedPin::write(((leds & kLedYellow) != 0) == kYellowLedHigh);
  GreenLedPin::write(((leds & kLedGreen) != 0) == kGreenLedHigh);
  RedLedPin::write(((leds & kLedRed) != 0) == kRedLedHigh);
}

void leds_init() {
  leds_write(0);
  YellowLedPin::make_output();
  GreenLedPin::make_output();
  RedLedPin::make_output();
}

}  // namespace avr
}  // namespace screed
