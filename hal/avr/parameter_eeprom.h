// The parameters in the MCU's EEPROM, in the format of firmware/parameters/parameter_store.h.
#pragma once

#include "firmware/parameters/parameter_store.h"

namespace screed {
namespace avr {

/// Reads the store; called once, before the others.
void parameter_eeprom_init();

StoreState parameter_store_state();

/// What a save writes. Begins as what was stored, or the defaults: the parameters of this start.
Parameters& parameter_draft();
void parameter_draft_defaults();

/// Begins to write the draft, one byte a tick; the new parameters hold from the next start on.
/// False when the draft is out of its range, or a write is under way.
bool parameter_save();
/// Stores one parameter, by its number in the table, from 1, among those that are stored; of the
/// draft nothing else. Begins once nothing else is being written. Others of the robot must not
/// contradict it. At most one in 1.5 s.
void parameter_store(uint8_t number, int16_t value);
/// The EEPROM is being written, by this or by others.
bool parameter_saving();

/// Writes the next byte when the EEPROM is ready; called once a tick, never waits.
void parameter_eeprom_step();

}  // namespace avr
}  // namespace screed
