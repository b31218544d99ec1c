// The parameters in the MCU's EEPROM, in the format of firmware/robot/parameter_store.h.
#pragma once

#include "firmware/robot/parameter_store.h"

namespace screed {
namespace avr {

/// Reads the store; called once, before the others.
void parameter_eeprom_init();

/// The parameters this start works with. They stay as they are until the next start.
const Parameters& parameters_in_force();
StoreState parameter_store_state();

/// A draft: begins as the parameters in force; what is written by the next save.
Parameters& parameter_draft();
void parameter_draft_defaults();

/// Begins to write the draft, one byte a tick; the new parameters hold from the next start on.
/// False when the draft is out of its range, or a write is under way.
bool parameter_save();
bool parameter_saving();

/// Writes the next byte when the EEPROM is ready; called once a tick, never waits.
void parameter_eeprom_step();

}  // namespace avr
}  // namespace screed
