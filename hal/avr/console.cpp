// A line console on the USB serial line. Numbers are hexadecimal, as in the lines of the radio: two
// digits, or four of a parameter's value (two's complement). Blanks do not matter.
//
//   v          version, board, health      p          all parameters, one a line: number, value
//   p NN       one parameter               p NN VVVV  changes the draft
//   d          the draft becomes the defaults
//   w          writes the draft; it holds from the next start on
//   r          stops the motors and restarts
//   k          is there a key (0, 1), the robot's id, number of this start
//   kKEYID     stores a key: 32 hexadecimal digits, 2 of the robot's id; it holds from the next
//              start on, and is never shown
//
// Numbers are those of the table in firmware/parameters/parameters.h, from 0. Anything else is
// answered with "?".
#include "hal/avr/console.h"

#include <avr/io.h>
#include <avr/pgmspace.h>
#include <string.h>

#include "build_info.h"
#include "firmware/protocol/slcan.h"
#include "hal/avr/buttons.h"
#include "hal/avr/credential_eeprom.h"
#include "hal/avr/parameter_eeprom.h"
#include "hal/avr/radio_uart.h"
#include "hal/avr/reset_cause.h"
#include "hal/avr/stack_guard.h"
#include "hal/avr/usb_serial.h"
#include "hal/avr/watchdog.h"

namespace screed {
namespace avr {
namespace {

constexpr uint8_t kInSize = 1 + 2 * kKeySize + 1;
constexpr uint8_t kOutSize = 50;
constexpr uint8_t kBytesPerStep = 16;

struct State {
  uint8_t in[kInSize];
  uint8_t in_count;  // kInSize: the line was too long
  uint8_t out[kOutSize];
  uint8_t out_count;
  uint8_t to_list;  // parameters that are still to be printed
};
State state;

void print(uint8_t byte) {
  if (state.out_count < kOutSize) state.out[state.out_count++] = byte;
}

void print_text(const char* text) {
  for (uint8_t byte = pgm_read_byte(text); byte != 0; byte = pgm_read_byte(++text)) print(byte);
}

__attribute__((noinline)) void print_byte(uint8_t byte) {
  uint8_t digits[2] = {};
  slcan_put_byte(digits, byte);
  print(digits[0]);
  print(digits[1]);
}

__attribute__((noinline)) void print_number(uint8_t value) {
  print(' ');
  print_byte(value);
}

__attribute__((noinline)) void print_word(uint16_t value) {
  print_number(static_cast<uint8_t>(value >> 8));
  print_byte(static_cast<uint8_t>(value & 0xFFU));
}

int16_t* draft_value(uint8_t index) {
  return reinterpret_cast<int16_t*>(&parameter_draft()) + index;
}

void print_parameter(uint8_t index) {
  print('p');
  print_number(index);
  print_word(static_cast<uint16_t>(*draft_value(index)));
}

bool parameter_command() {
  if (state.in_count == 1) {
    state.to_list = kParameterCount;
    return true;
  }
  uint8_t index = 0;
  if ((state.in_count != 3 && state.in_count != 7) || !slcan_byte(state.in + 1, index) ||
      index >= kParameterCount) {
    return false;
  }
  if (state.in_count == 7) {
    uint8_t high = 0;
    uint8_t low = 0;
    if (!slcan_byte(state.in + 3, high) || !slcan_byte(state.in + 5, low)) return false;
    *draft_value(index) = static_cast<int16_t>(static_cast<uint16_t>(high) << 8 | low);
  }
  print_parameter(index);
  return true;
}

void print_ok() {
  print_text(PSTR("ok"));
}

bool key_command() {
  if (state.in_count == 1) {
    print('k');
    print_number(credentials().key_set ? 1 : 0);
    print_number(credentials().robot_id);
    print_word(credentials().boot_epoch);
    return true;
  }
  if (state.in_count != 1 + 2 * kKeySize) return false;
  uint8_t key[kKeySize];
  for (uint8_t i = 0; i < kKeySize; ++i) {
    const uint8_t* const digits = state.in + 1 + 2 * i;
    if (!slcan_byte(digits, key[i])) return false;
  }
  if (!credential_eeprom_store(key)) return false;
  print_ok();
  return true;
}

void print_health() {
  print_text(PSTR("screed " SCREED_VERSION " " SCREED_BOARD));
  print_number(static_cast<uint8_t>(reset_cause()));
  print_number(static_cast<uint8_t>(parameter_store_state()));
  print_word(stack_free());
  print_number(radio_uart_overruns());
  print_number(buttons_read());
}

/// False: not understood, or not possible now.
__attribute__((noinline)) bool execute() {
  const uint8_t command = state.in[0];
  if (command == 'p') return parameter_command();
  if (command == 'k') return key_command();
  if (state.in_count != 1) return false;
  switch (command) {
    case 'v':
      print_health();
      return true;
    case 'd':
      parameter_draft_defaults();
      break;
    case 'w':
      if (!parameter_save()) return false;
      break;
    case 'r':
      if (parameter_saving()) return false;
      set_next_reset_cause(ResetCause::kRequested);
      watchdog_reset_now();
    default:
      return false;
  }
  print_ok();
  return true;
}

void end_line() {
  if (state.in_count != 0) {
    if (state.in_count == kInSize || !execute()) print('?');
    if (state.out_count != 0) print('\n');
  }
  state.in_count = 0;
}

}  // namespace

void console_step() {
  if (state.out_count == 0 && state.to_list != 0) {
    print_parameter(static_cast<uint8_t>(kParameterCount - state.to_list));
    --state.to_list;
    print('\n');
  }
  if (state.out_count != 0) {
    if (usb_serial_put(state.out, state.out_count)) state.out_count = 0;
    return;
  }
  uint8_t byte = 0;
  for (uint8_t i = 0; i < kBytesPerStep && usb_serial_get(byte); ++i) {
    if (byte == '\r' || byte == '\n') {
      end_line();
      return;
    }
    if (byte != ' ' && state.in_count < kInSize) state.in[state.in_count++] = byte;
  }
}

}  // namespace avr
}  // namespace screed
