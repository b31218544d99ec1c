// Key and number of starts in the EEPROM, in the format of firmware/security/key_store.h.
#pragma once

#include "firmware/security/key_store.h"

namespace screed {
namespace avr {

/// Reads key and number, and writes the number of this start, 14 ms; called once, before the
/// others.
void credential_eeprom_init();

const Credentials& credentials();

/// Begins to store a key and the robot's id behind it, which hold from the next start on. False
/// while something else is being written.
bool credential_eeprom_store(const uint8_t (&key)[kKeySize]);

}  // namespace avr
}  // namespace screed
