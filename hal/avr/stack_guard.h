// The stack, watched while the program runs: RAM between variables and stack is painted at start,
// and the lowest painted bytes must stay.
//
// The build proves that the stack keeps its distance (tools/avr/stack); this is the second witness.
#pragma once

#include <stdint.h>

namespace screed {
namespace avr {

/// The bytes next to the variables are untouched.
bool stack_intact();

/// Looks at a few bytes; called once a tick.
void stack_guard_step();

/// Bytes that the stack has never reached, as of the last complete look (about two seconds old);
/// 0 before the first.
uint16_t stack_free();

}  // namespace avr
}  // namespace screed
