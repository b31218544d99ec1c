// Reads what `avr-size -A` prints.
#include "tools/avr/stack/image_size.h"

#include <sstream>
#include <string>

#include "host_sim/core/errors.h"

namespace screed::avr_stack {

ImageSize read_image_size(std::istream& in) {
  ImageSize size;
  bool has_text = false;
  std::string line;
  while (std::getline(in, line)) {
    std::istringstream fields(line);
    std::string section;
    std::uint32_t bytes = 0;
    if (!(fields >> section >> bytes)) continue;
    has_text = has_text || section == ".text";
    if (section == ".text" || section == ".data") size.flash += bytes;
    if (section == ".data" || section == ".bss" || section == ".noinit") size.static_ram += bytes;
  }
  if (!has_text) {
    throw InputError("no section .text in the input; expected the output of `avr-size -A`");
  }
  return size;
}

}  // namespace screed::avr_stack
