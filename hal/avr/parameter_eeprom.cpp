// The parameters in the MCU's EEPROM.
#include "hal/avr/parameter_eeprom.h"

#include <avr/io.h>
#include <avr/pgmspace.h>
#include <util/atomic.h>

namespace screed {
namespace avr {
namespace {

const Parameters kDefaults PROGMEM;

/// Parameters that are filled later: their default values would cost a constructor's code.
union LateParameters {
  Parameters value;
  LateParameters() {}
};
LateParameters in_force;
LateParameters draft;

void set_defaults(LateParameters& parameters) {
  memcpy_P(&parameters, &kDefaults, sizeof(kDefaults));
}

struct State {
  StoreState store;
  ParameterCopy copy;  // what is being written
  bool has_good_copy;
  uint8_t copies;  // still to write
  uint8_t next_copy;
  uint8_t at;
  uint16_t next_sequence;
};
State state;

uint8_t eeprom_byte(uint16_t address) {
  while ((EECR & _BV(EEPE)) != 0) {  // a write that a reset interrupted, 3.4 ms at most
  }
  EEAR = address;
  EECR |= _BV(EERE);
  return EEDR;
}

void read_copy(uint8_t index, ParameterCopy& copy) {
  const uint16_t begin = kParameterCopyAt(index);
  for (uint8_t i = 0; i < kParameterCopySize; ++i) {
    copy.bytes[i] = eeprom_byte(static_cast<uint16_t>(begin + i));
  }
}

}  // namespace

void parameter_eeprom_init() {
  CopyState states[kParameterCopies];
  uint16_t sequences[kParameterCopies];
  for (uint8_t i = 0; i < kParameterCopies; ++i) {
    read_copy(i, state.copy);
    states[i] = check_copy(state.copy);
    sequences[i] = copy_sequence(state.copy);
  }
  const StoreChoice choice = choose_copy(states[0], sequences[0], states[1], sequences[1]);
  state.store = choice.state;
  state.has_good_copy = choice.state == StoreState::kStored;
  state.next_copy = choice.next_copy;
  state.next_sequence = choice.next_sequence;
  set_defaults(in_force);
  if (choice.state == StoreState::kStored) {
    read_copy(choice.copy, state.copy);
    decode_parameters(state.copy, in_force.value);
  }
  draft.value = in_force.value;
}

const Parameters& parameters_in_force() {
  return in_force.value;
}
StoreState parameter_store_state() {
  return state.store;
}
Parameters& parameter_draft() {
  return draft.value;
}
void parameter_draft_defaults() {
  set_defaults(draft);
}

bool parameter_save() {
  if (state.copies != 0 || !draft.value.valid()) return false;
  encode_parameters(draft.value, state.next_sequence, state.copy);
  state.next_sequence = static_cast<uint16_t>(state.next_sequence + 1U);
  state.at = 0;
  // A store without a good copy gets two at once.
  state.copies = state.has_good_copy ? 1 : kParameterCopies;
  state.has_good_copy = true;
  return true;
}

bool parameter_saving() {
  return state.copies != 0;
}

void parameter_eeprom_step() {
  if (state.copies == 0 || (EECR & _BV(EEPE)) != 0) return;
  EEAR = static_cast<uint16_t>(kParameterCopyAt(state.next_copy) + state.at);
  EEDR = state.copy.bytes[state.at];
  ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {  // EEPE counts within four cycles after EEMPE
    EECR = _BV(EEMPE);
    EECR = _BV(EEMPE) | _BV(EEPE);
  }
  if (++state.at < kParameterCopySize) return;
  state.at = 0;
  state.next_copy = static_cast<uint8_t>(1 - state.next_copy);
  --state.copies;
}

}  // namespace avr
}  // namespace screed
