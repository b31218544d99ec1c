// The EEPROM, a byte a tick.
#include "hal/avr/eeprom.h"

#include <avr/io.h>
#include <avr/pgmspace.h>
#include <string.h>

#include "hal/avr/interrupts_off.h"

namespace screed {

namespace avr {
namespace {

struct Writing {
  const uint8_t* next;
  uint16_t address;
  uint8_t left;
};
Writing writing;

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
  writing.next = bytes;
  writing.address = address;
  writing.left = count;
}

bool eeprom_busy() {
  return writing.left != 0;
}

void eeprom_step() {
  if (writing.left == 0 || (EECR & _BV(EEPE)) != 0) return;
  EEAR = writing.address++;
  EEDR = *writing.next++;
  {
    const InterruptsOff interrupts_off;  // EEPE counts within four cycles after EEMPE
    EECR = _BV(EEMPE);
    EECR = _BV(EEMPE) | _BV(EEPE);
  }
  --writing.left;
}

// The parameters in the MCU's EEPROM.

namespace {

const Parameters kDefaults PROGMEM;

/// Parameters that are filled later: their default values would cost a constructor's code.
union LateParameters {
  uint8_t bytes[sizeof(Parameters)];
  Parameters value;
  constexpr LateParameters() : bytes() {}
};
LateParameters in_force;  // what the robot drives with: of this start, and remote changes since

/// A copy whose values can be looked at.
union Copy {
  ParameterCopy bytes;
  struct {
    uint8_t header[kParameterHeaderSize];
    Parameters values;
  } parts;
  constexpr Copy() : bytes() {}
};

Copy copy;  // what is stored, or is being written

struct State {
  StoreState store;
  uint8_t copies;       // still to write
  uint8_t copies_next;  // that the next save writes
  uint8_t next_copy;
  uint16_t next_sequence;
  uint8_t pending;  // a parameter that waits to be stored, by its number; 0: none
  int16_t pending_value;
};
State state;

__attribute__((noinline)) void read_copy(uint8_t index) {
  eeprom_read(parameter_copy_address(index), copy.bytes.bytes, kParameterCopySize);
}

void put(Parameters& parameters, uint8_t number, int16_t value) {
  parameters.values[number - 1] = value;
}

__attribute__((noinline)) void take_defaults() {
  memcpy_P(&copy.parts.values, &kDefaults, sizeof(kDefaults));
}

/// Begins to write copy.
void begin_save() {
  seal_copy(state.next_sequence, copy.bytes);
  state.next_sequence = static_cast<uint16_t>(state.next_sequence + 1U);
  state.copies = state.copies_next;
  state.copies_next = 1;
}

}  // namespace

void parameter_eeprom_init() {
  CopyState states[kParameterCopies];
  uint16_t sequences[kParameterCopies];
  for (uint8_t i = 0; i < kParameterCopies; ++i) {
    read_copy(i);
    states[i] = check_copy(copy.bytes);
    sequences[i] = copy_sequence(copy.bytes);
  }
  const StoreChoice choice = choose_copy(states[0], sequences[0], states[1], sequences[1]);
  state.store = choice.state;
  state.next_copy = choice.next_copy;
  state.next_sequence = choice.next_sequence;
  if (choice.state == StoreState::kStored) {
    read_copy(choice.copy);
    state.copies_next = 1;
  } else {
    take_defaults();
    state.copies_next = kParameterCopies;  // a store without a good copy gets two at once
  }
  in_force.value = copy.parts.values;
}

StoreState parameter_store_state() {
  return state.store;
}
const Parameters& parameters_of_start() {
  return in_force.value;
}

bool parameter_save_defaults() {
  if (parameter_saving()) return false;
  take_defaults();
  begin_save();
  return true;
}

void parameter_store(uint8_t number, int16_t value) {
  put(in_force.value, number, value);
  state.pending = number;
  state.pending_value = value;
}

bool parameter_saving() {
  return (state.copies | state.pending | writing.left) != 0;
}

__attribute__((noinline)) void parameter_eeprom_step() {
  eeprom_step();
  if (eeprom_busy()) return;
  if (state.copies == 0) {
    if (state.pending == 0) return;
    Parameters& stored = copy.parts.values;
    put(stored, state.pending, state.pending_value);
    state.pending = 0;
    // What was saved for the next start may contradict it; what the robot drives with does not.
    if (!stored.valid()) stored = in_force.value;
    begin_save();
  }
  eeprom_write(parameter_copy_address(state.next_copy), copy.bytes.bytes, kParameterCopySize);
  state.next_copy = static_cast<uint8_t>(1 - state.next_copy);
  --state.copies;
}

// Key and number of starts in the EEPROM.

namespace {

struct Credential {
  Credentials in_force;
  CredentialRecord record;  // what is being written
};
Credential credential;

}  // namespace

void credential_eeprom_init() {
  eeprom_read(kCredentialRecordAddress, credential.record.bytes, kCredentialRecordSize);
  if (!begin_start(credential.record, credential.in_force)) return;
  const uint8_t slot = epoch_slot_offset(credential.in_force.boot_epoch);
  eeprom_write(kCredentialRecordAddress + slot, credential.record.bytes + slot, kEpochSlotSize);
  while (eeprom_busy()) eeprom_step();
}

const Credentials& credentials() {
  return credential.in_force;
}

bool credential_eeprom_store(const uint8_t* key) {
  if (eeprom_busy()) return false;
  put_key(credential.record, key);
  eeprom_write(kCredentialRecordAddress, credential.record.bytes, kCredentialRecordSize);
  return true;
}

}  // namespace avr

}  // namespace screed
