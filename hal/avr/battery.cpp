// The battery voltage at the ADC: one conversion a tick (104 us, done long before the next), summed
// over eight ticks.
#include "hal/avr/battery.h"

#include <avr/io.h>

#include "pins.h"

namespace screed {
namespace avr {
namespace {

constexpr uint8_t kWindow = 8;

struct State {
  uint16_t window[kWindow];
  uint8_t at;
  uint16_t sum;
};
State state;

void start_conversion() {
  ADCSRA |= _BV(ADSC);
}

/// Takes the result of a conversion that has ended, and starts the next one.
__attribute__((noinline)) void take() {
  const uint16_t conversion = ADC;
  uint16_t& oldest = state.window[state.at];
  state.sum = static_cast<uint16_t>(state.sum - oldest + conversion);
  oldest = conversion;
  state.at = static_cast<uint8_t>((state.at + 1U) % kWindow);
  start_conversion();
}

bool converting() {
  return (ADCSRA & _BV(ADSC)) != 0;
}

}  // namespace

void battery_init() {
  ADMUX =
      static_cast<uint8_t>(_BV(REFS0) | (kBatteryChannel & 0x07U));  // reference: the 5 V supply
  ADCSRB = 0;
  DIDR0 = static_cast<uint8_t>(1U << kBatteryChannel);
  ADCSRA = _BV(ADEN) | _BV(ADPS2) | _BV(ADPS1) | _BV(ADPS0);  // 125 kHz
  start_conversion();
  for (uint8_t i = 0; i < kWindow; ++i) {
    while (converting()) {
    }
    take();
  }
}

uint16_t battery_read() {
  if (!converting()) take();
  return state.sum;
}

}  // namespace avr
}  // namespace screed
