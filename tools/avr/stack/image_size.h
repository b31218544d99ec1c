// Reads what `avr-size -A` prints: how much flash and static RAM a linked image takes.
#pragma once

#include <cstdint>
#include <istream>
#include <map>
#include <string>
#include <vector>

namespace screed::avr_stack {

struct ImageSize {
  std::uint32_t flash = 0;       ///< bytes: program and initial values of variables
  std::uint32_t static_ram = 0;  ///< bytes: variables with and without initial values
};

/// Throws InputError when the text has no .text section.
ImageSize read_image_size(std::istream& in);

// What the indirect calls and jumps of an image may reach, as people have stated it: the stack
// analysis cannot see it, and refuses every indirect call that is not listed.
//
//   # a comment
//   FUNCTION -> TARGET | TARGET    the calls in FUNCTION reach one of these
//   FUNCTION -> never              the calls in FUNCTION are not reached
//
// Names are demangled, without the " [clone ...]" that the compiler may add. A target that ends in
// * stands for every symbol that begins so; a target must exist in the image.

/// Targets by function; empty: never reached.
using IndirectCalls = std::map<std::string, std::vector<std::string>>;

/// Throws InputError with the line when one is not of this form or names a function twice.
IndirectCalls read_indirect_calls(std::istream& in);

}  // namespace screed::avr_stack
