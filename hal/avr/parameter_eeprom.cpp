// The parameters in the MCU's EEPROM.
#include "hal/avr/parameter_eeprom.h"

#include <avr/pgmspace.h>
#include <string.h>

#include "hal/avr/eeprom.h"

namespace screed {
namespace avr {
namespace {

const Parameters kDefaults PROGMEM;

/// Parameters that are filled later: their default values would cost a constructor's code.
union LateParameters {
  uint8_t bytes[sizeof(Parameters)];
  Parameters value;
  constexpr LateParameters() : bytes() {}
};
LateParameters draft;

struct State {
  StoreState store;
  ParameterCopy copy;  // what is being written
  bool has_good_copy;
  uint8_t copies;  // still to write
  uint8_t next_copy;
  uint16_t next_sequence;
};
State state;

void read_copy(uint8_t index, ParameterCopy& copy) {
  eeprom_read(parameter_copy_address(index), copy.bytes, kParameterCopySize);
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
  parameter_draft_defaults();
  if (choice.state == StoreState::kStored) {
    read_copy(choice.copy, state.copy);
    decode_parameters(state.copy, parameter_draft());
  }
}

StoreState parameter_store_state() {
  return state.store;
}
Parameters& parameter_draft() {
  return draft.value;
}
void parameter_draft_defaults() {
  memcpy_P(draft.bytes, &kDefaults, sizeof(kDefaults));
}

bool parameter_save() {
  if (parameter_saving() || !parameter_draft().valid()) return false;
  encode_parameters(parameter_draft(), state.next_sequence, state.copy);
  state.next_sequence = static_cast<uint16_t>(state.next_sequence + 1U);
  // A store without a good copy gets two at once.
  state.copies = state.has_good_copy ? 1 : kParameterCopies;
  state.has_good_copy = true;
  return true;
}

bool parameter_store(uint8_t number, int16_t value) {
  memcpy(draft.bytes + sizeof(value) * (number - 1U), &value, sizeof(value));
  return parameter_save();
}

bool parameter_saving() {
  return state.copies != 0 || eeprom_busy();
}

void parameter_eeprom_step() {
  eeprom_step();
  if (state.copies == 0 || eeprom_busy()) return;
  eeprom_write(parameter_copy_address(state.next_copy), state.copy.bytes, kParameterCopySize);
  state.next_copy = static_cast<uint8_t>(1 - state.next_copy);
  --state.copies;
}

}  // namespace avr
}  // namespace screed
