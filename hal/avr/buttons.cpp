// The user's push buttons: each connects its pin to ground.
#include "hal/avr/buttons.h"

#include <util/delay.h>

#include "hal/avr/interrupts_off.h"
#include "pins.h"

namespace screed {
namespace avr {
namespace {

/// A pin that drives an LED, let go for a moment.
template <typename Pin>
struct SharedPin {
  bool led = Pin::is_driven_high();

  SharedPin() {
    Pin::make_input();
    Pin::set();  // pull-up
  }
  ~SharedPin() {
    if (!led) Pin::clear();
    Pin::make_output();
  }
  SharedPin(const SharedPin&) = delete;
  SharedPin& operator=(const SharedPin&) = delete;
};

}  // namespace

void buttons_init() {
  ButtonAPin::make_input();
  ButtonAPin::set();  // pull-up
}

bool button_a_held() {
  return !ButtonAPin::is_high();
}

uint8_t buttons_read() {
  uint8_t held = ButtonAPin::is_high() ? 0 : kButtonA;
  // The Arduino core's USB interrupts write to the same pins (its "TX" and "RX" LEDs).
  {
    const InterruptsOff interrupts_off;
    const SharedPin<ButtonBPin> b;
    const SharedPin<ButtonCPin> c;
    _delay_us(3);  // until the pull-up has charged the pin (Pololu's library waits as long)
    if (!ButtonBPin::is_high()) held |= kButtonB;
    if (!ButtonCPin::is_high()) held |= kButtonC;
  }
  return held;
}

}  // namespace avr
}  // namespace screed
