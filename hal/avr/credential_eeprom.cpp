// Key and number of starts in the EEPROM.
#include "hal/avr/credential_eeprom.h"

#include "hal/avr/eeprom.h"

namespace screed {
namespace avr {
namespace {

struct State {
  Credentials in_force;
  CredentialRecord record;  // what is being written
};
State state;

}  // namespace

void credential_eeprom_init() {
  eeprom_read(kCredentialRecordAddress, state.record.bytes, kCredentialRecordSize);
  if (!begin_start(state.record, state.in_force)) return;
  const uint8_t slot = epoch_slot_offset(state.in_force.boot_epoch);
  eeprom_write(kCredentialRecordAddress + slot, state.record.bytes + slot, kEpochSlotSize);
  while (eeprom_busy()) eeprom_step();
}

const Credentials& credentials() {
  return state.in_force;
}

bool credential_eeprom_store(const uint8_t (&key)[kKeySize]) {
  if (eeprom_busy()) return false;
  put_key(state.record, key);
  eeprom_write(kCredentialRecordAddress, state.record.bytes, kCredentialRecordSize);
  return true;
}

}  // namespace avr
}  // namespace screed
