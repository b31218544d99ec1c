// A line console on the USB serial line, for a person or a tool (docs/boards.md lists its
// commands).
#pragma once

namespace screed {
namespace avr {

/// Reads what was typed and writes what is due; called once a tick, never waits.
void console_step();

}  // namespace avr
}  // namespace screed
