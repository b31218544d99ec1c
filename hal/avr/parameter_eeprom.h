// The parameters in the MCU's EEPROM, in the format of firmware/parameters/parameter_store.h.
#pragma once

#include "firmware/parameters/parameter_store.h"

namespace screed {
namespace avr {

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

}  // namespace avr
}  // namespace screed
