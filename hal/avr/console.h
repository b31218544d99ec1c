// A line console on the USB serial line, for a person or a tool (docs/boards.md lists its
// commands).
#pragma once

#include <stdint.h>

namespace screed {
namespace avr {

/// Reads what was typed and writes what is due; called once a tick, never waits.
void console_step();

/// The motor whose test goes on: 'l', 'r', or 0.
uint8_t console_tested_motor();

/// What the robot hands to its radio goes to USB as well, when somebody there has asked for it. The
/// lines stay as they are for two ticks.
void console_mirror(const uint8_t* lines, uint8_t count);

}  // namespace avr
}  // namespace screed
