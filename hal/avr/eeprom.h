// The EEPROM, a byte a tick. Nothing here waits, but for a read while a byte is being written.
#pragma once

#include <stdint.h>

namespace screed {
namespace avr {

/// Waits for a write that is under way, 3.4 ms at most.
void eeprom_read(uint16_t address, uint8_t* bytes, uint8_t count);

/// Begins to write bytes, which must stay as they are until it has ended. Only when not busy.
void eeprom_write(uint16_t address, const uint8_t* bytes, uint8_t count);
bool eeprom_busy();

/// Writes the next byte when the EEPROM is ready; called once a tick.
void eeprom_step();

}  // namespace avr
}  // namespace screed
