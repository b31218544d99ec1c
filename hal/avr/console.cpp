// A line console on the USB serial line. Numbers are hexadecimal, as in the lines of the radio: two
// digits, or four. Blanks do not matter.
//
//   v          version, board, health
//   d          stores the default parameters; they hold from the next start on
//   r          stops the motors and restarts
//   k          is there a key (0, 1), the robot's id, number of this start
//   kKEYID     stores a key: 32 hexadecimal digits, 2 of the robot's id; it holds from the next
//              start on, and is never shown
//   ml, mr     turns the left or right motor forwards at a fifth of full duty, for a second, while
//              button A is held and the yellow and the red LED are off
//   O          the lines of the radio come by USB as well, until C (SLCAN: open, close)
//   t...       a line of the radio, taken whole as if it had come by radio. One that comes by radio
//              at that moment is lost with it; senders repeat
//
// Anything else is answered with "?".
#include "hal/avr/console.h"

#include <avr/io.h>
#include <avr/pgmspace.h>
#include <string.h>

#include "build_info.h"
#include "firmware/protocol/slcan.h"
#include "hal/avr/buttons.h"
#include "hal/avr/eeprom.h"
#include "hal/avr/radio_uart.h"
#include "hal/avr/reset_cause.h"
#include "hal/avr/stack_guard.h"
#include "hal/avr/usb_serial.h"
#include "hal/avr/watchdog.h"
#include "hal/sample.h"

namespace screed {
namespace avr {
namespace {

constexpr uint8_t kInSize = 1 + 2 * kKeySize + 1;
// Of the longest answer, that to `v`: its text, numbers of two digits and of four, the line's end.
// A modified tree's version is longer than a commit's.
constexpr uint8_t kOutSize = sizeof("screed " SCREED_VERSION " " SCREED_BOARD) - 1 + 4 * 3 + 5 + 1;
static_assert(kOutSize <= kUsbSerialPut, "the name of this board is too long");
constexpr uint8_t kBytesPerStep = 16;
constexpr uint8_t kMirrored = kRadioOutCapacity / 2;  // the next tick has no lines

struct State {
  uint8_t in[kInSize];
  uint8_t in_count;  // kInSize: the line was too long
  uint8_t out[kOutSize];
  uint8_t out_count;
  bool mirror;  // the radio's lines go out here as well
  const uint8_t* lines;
  uint8_t lines_left;
  uint8_t test_ticks;
  uint8_t test_motor;
};
State state;

void print(uint8_t byte) {
  if (state.out_count < kOutSize) state.out[state.out_count++] = byte;
}

void print_text(const char* text) {
  for (uint8_t byte = pgm_read_byte(text); byte != 0; byte = pgm_read_byte(++text)) print(byte);
}

__attribute__((noinline)) void print_byte(uint8_t byte) {
  if (state.out_count > kOutSize - 2) return;
  slcan_put_byte(state.out + state.out_count, byte);
  state.out_count = static_cast<uint8_t>(state.out_count + 2);
}

__attribute__((noinline)) void print_number(uint8_t value) {
  print(' ');
  print_byte(value);
}

__attribute__((noinline)) void print_word(uint16_t value) {
  print_number(static_cast<uint8_t>(value >> 8));
  print_byte(static_cast<uint8_t>(value & 0xFFU));
}

bool motor_command() {
  const uint8_t side = state.in[1];
  if (state.in_count != 2 || (side != 'l' && side != 'r')) return false;
  state.test_motor = side;
  state.test_ticks = kTickRate_hz;
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
  // The bytes take the place of digits before them.
  const uint8_t* digits = state.in + 1;
  for (uint8_t i = 0; i < kKeySize; ++i, digits += 2) {
    if (!slcan_byte(digits, state.in[i])) return false;
  }
  if (!credential_eeprom_store(state.in)) return false;
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
  if (command == 'k') return key_command();
  if (command == 'm') return motor_command();
  if (command == 't') {
    state.in[state.in_count] = '\r';
    return radio_uart_inject(state.in, static_cast<uint8_t>(state.in_count + 1));
  }
  if (state.in_count != 1) return false;
  switch (command) {
    case 'v':
      print_health();
      return true;
    case 'd':
      if (!parameter_save_defaults()) return false;
      break;
    case 'O':
    case 'C':
      state.mirror = command == 'O';
      return true;
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

uint8_t console_tested_motor() {
  return state.test_ticks != 0 && button_a_held() ? state.test_motor : 0;
}

void console_mirror(const uint8_t* lines, uint8_t count) {
  if (count == 0 || !state.mirror) return;
  // An answer goes between two packets, never into one: that packet is left out.
  state.lines = lines;
  state.lines_left = state.out_count == 0 ? count : 0;
}

void console_step() {
  if (state.test_ticks != 0) --state.test_ticks;
  if (state.lines_left != 0) {
    const uint8_t count = state.lines_left < kMirrored ? state.lines_left : kMirrored;
    if (usb_serial_put(state.lines, count)) {
      state.lines += count;
      state.lines_left = static_cast<uint8_t>(state.lines_left - count);
    }
  } else if (state.out_count != 0 && usb_serial_put(state.out, state.out_count)) {
    state.out_count = 0;
  }
  if (state.out_count != 0) return;
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
