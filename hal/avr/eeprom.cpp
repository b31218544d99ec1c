// The EEPROM, a byte a tick.
#include "hal/avr/eeprom.h"

#include <avr/io.h>
#include <util/atomic.h>

namespace screed {
namespace avr {
namespace {

struct State {
  const uint8_t* next;
  uint16_t address;
  uint8_t left;
};
State state;

}  // namespace

void eeprom_read(uint16_t address, uint8_t* bytes, uint8_t count) {
  while ((EECR & _BV(EEPE)) != 0) {  // also one that a reset interrupted
  }
  for (; count > 0; --count) {
    EEAR = address++;
    EECR |= _BV(EERE);
    *bytes++ = EEDR;
  }
}

__attribute__((noinline)) void eeprom_write(uint16_t address, const uint8_t* bytes, uint8_t count) {
  state.next = bytes;
  state.address = address;
  state.left = count;
}

bool eeprom_busy() {
  return state.left != 0;
}

void eeprom_step() {
  if (state.left == 0 || (EECR & _BV(EEPE)) != 0) return;
  EEAR = state.address++;
  EEDR = *state.next++;
  ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {  // EEPE counts within four cycles after EEMPE
    EECR = _BV(EEMPE);
    EECR = _BV(EEMPE) | _BV(EEPE);
  }
  --state.left;
}

}  // namespace avr
}  // namespace screed
