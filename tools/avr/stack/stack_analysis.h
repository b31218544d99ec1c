// Worst-case stack of an AVR image, from its instructions alone.
//
// The program is walked from the reset vector and from every interrupt vector along all paths, with
// the height of the stack carried along: push and pop, calls (2 bytes of return address on devices
// with up to 128 kB of flash), and frames that are made by writing the stack pointer from Y. Tail
// jumps and falling into the next function are plain paths, and so are the prologues and epilogues
// that functions share (-mcall-prologues), whose frame and way back are constants in X and Z. What
// cannot be bounded is refused with RunError and the place: recursion, indirect calls and jumps
// that are not listed, a height that differs between two paths to one instruction, a stack pointer
// from an unknown value, `sei` in an interrupt.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/avr/stack/disassembly.h"
#include "tools/avr/stack/image_size.h"

namespace screed::avr_stack {

/// One function on the deepest path.
struct StackFrame {
  std::string name;         ///< demangled
  std::uint32_t bytes = 0;  ///< its return address and what it holds at the deepest point
};

/// The deepest path from one entry point; the frames add up to `bytes`.
struct StackPath {
  std::string entry;  ///< "reset" or the name of the interrupt function
  std::uint32_t bytes = 0;
  std::vector<StackFrame> frames;
};

struct StackReport {
  StackPath main;                     ///< from reset
  std::vector<StackPath> interrupts;  ///< deepest first; return address included

  /// Interrupts do not nest: the deepest of them comes on top of the deepest main path.
  std::uint32_t worst_case() const {
    return main.bytes + (interrupts.empty() ? 0 : interrupts.front().bytes);
  }
};

/// Throws RunError when a bound does not exist or cannot be proved, InputError when the text is not
/// a whole image with a vector table, or when a listed target is not in it.
StackReport analyze(const Disassembly& program, const IndirectCalls& indirect = {});

}  // namespace screed::avr_stack
