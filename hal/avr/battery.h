// The battery voltage at the ADC.
#pragma once

#include <stdint.h>

namespace screed {
namespace avr {

/// Fills the window of eight samples; takes 1 ms.
void battery_init();

/// Takes one conversion (started the last time) and starts the next. Returns the sum of the last
/// eight conversions, 10 bits each.
uint16_t battery_read();

}  // namespace avr
}  // namespace screed
