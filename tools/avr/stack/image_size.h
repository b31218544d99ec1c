// Reads what `avr-size -A` prints: how much flash and static RAM a linked image takes.
#pragma once

#include <cstdint>
#include <istream>

namespace screed::avr_stack {

struct ImageSize {
  std::uint32_t flash = 0;       ///< bytes: program and initial values of variables
  std::uint32_t static_ram = 0;  ///< bytes: variables with and without initial values
};

/// Throws InputError when the text has no .text section.
ImageSize read_image_size(std::istream& in);

}  // namespace screed::avr_stack
