// The EEPROM, a byte a tick. Nothing here waits, but for a read while a byte is being written.
#pragma once

#include <stdint.h>

#include "firmware/parameters/parameter_store.h"
#include "firmware/security/key_store.h"

namespace screed {

namespace avr {

/// Waits for a write that is under way, 3.4 ms at most.
void eeprom_read(uint16_t address, uint8_t* bytes, uint8_t count);

/// Begins to write bytes, which must stay as they are until it has ended. Only when not busy.
void eeprom_write(uint16_t address, const uint8_t* bytes, uint8_t count);
bool eeprom_busy();

/// Writes the next byte when the EEPROM is ready; called once a tick.
void eeprom_step();

// The parameters in the MCU's EEPROM, in the format of firmware/parameters/parameter_store.h.

/// Reads the store; called once, before the others.
void parameter_eeprom_init();

StoreState parameter_store_state();

/// Of this start: what was stored, or the defaults.
const Parameters& parameters_of_start();

/// Begins to write the defaults, one byte a tick; they hold from the next start on. False when a
/// write is under way.
bool parameter_save_defaults();
/// Stores one parameter, by its number in the table, from 1, among those that are stored. Begins
/// once nothing else is being written. Others of the robot must not contradict it. At most one in
/// 1.5 s.
void parameter_store(uint8_t number, int16_t value);
/// The EEPROM is being written, by this or by others.
bool parameter_saving();

/// Writes the next byte when the EEPROM is ready; called once a tick, never waits.
void parameter_eeprom_step();

// Key and number of starts in the EEPROM, in the format of firmware/security/key_store.h.

/// Reads key and number, and writes the number of this start, 14 ms; called once, before the
/// others.
void credential_eeprom_init();

const Credentials& credentials();

/// Begins to store a key and the robot's id behind it, kKeySize bytes, which hold from the next
/// start on. False while something else is being written.
bool credential_eeprom_store(const uint8_t* key);

}  // namespace avr

}  // namespace screed
