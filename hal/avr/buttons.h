// The user's push buttons.
#pragma once

#include <stdint.h>

namespace screed {
namespace avr {

enum ButtonBit : uint8_t { kButtonA = 1 << 0, kButtonB = 1 << 1, kButtonC = 1 << 2 };

void buttons_init();

/// The buttons that are held down, ButtonBit set. Two buttons share their pins with LEDs, which are
/// let go for 3 us. A contact bounces for a few milliseconds: ask once a tick, and take what two
/// answers agree on.
uint8_t buttons_read();
/// A alone.
bool button_a_held();

}  // namespace avr
}  // namespace screed
