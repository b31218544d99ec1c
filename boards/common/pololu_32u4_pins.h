// What Pololu's boards with the ATmega32U4 have in common (A-Star 32U4 family and the robots built
// on it): LEDs, buttons, battery input. For pins.h of such a board; for hal/avr only.
// Source: Pololu, "A-Star 32U4 User's Guide" 6 and "Zumo 32U4 User's Guide" 3.
#pragma once

#include "hal/avr/pin.h"

namespace screed {
namespace avr {

// LEDs and the level that lights them.
using RedLedPin = Pin<kPortB, 0>;     // pin 17
using YellowLedPin = Pin<kPortC, 7>;  // pin 13
using GreenLedPin = Pin<kPortD, 5>;
constexpr bool kRedLedHigh = false;
constexpr bool kYellowLedHigh = true;
constexpr bool kGreenLedHigh = false;

// Buttons; B and C share their pins with LEDs.
using ButtonAPin = Pin<kPortB, 3>;  // pin 14
using ButtonBPin = GreenLedPin;
using ButtonCPin = RedLedPin;

constexpr uint8_t kBatteryChannel = 6;  // A1 = PF6

}  // namespace avr
}  // namespace screed
