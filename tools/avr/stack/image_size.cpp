// Reads what `avr-size -A` prints.
#include "tools/avr/stack/image_size.h"

#include <sstream>
#include <string>
#include <string_view>

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

// Reads the list of indirect calls.

namespace {

constexpr std::string_view kArrow = " -> ";
constexpr std::string_view kNever = "never";

std::string trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return std::string(text.substr(first, text.find_last_not_of(" \t\r") - first + 1));
}

}  // namespace

IndirectCalls read_indirect_calls(std::istream& in) {
  IndirectCalls result;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    const std::string text = trimmed(line);
    if (text.empty() || text.front() == '#') continue;
    const auto fail = [&](const char* why) -> InputError {
      return InputError("indirect calls, line " + std::to_string(number) + ": " + why);
    };
    const auto arrow = text.find(kArrow);
    if (arrow == std::string::npos) throw fail("expected FUNCTION -> TARGET | TARGET");
    const auto [entry, is_new] = result.try_emplace(trimmed(text.substr(0, arrow)));
    if (!is_new) throw fail("this function is listed already");
    std::string_view rest = std::string_view(text).substr(arrow + kArrow.size());
    if (trimmed(rest) == kNever) continue;
    for (bool more = true; more;) {
      const auto bar = rest.find('|');
      entry->second.push_back(trimmed(rest.substr(0, bar)));
      if (entry->second.back().empty()) throw fail("a target without a name");
      more = bar != std::string_view::npos;
      if (more) rest.remove_prefix(bar + 1);
    }
  }
  return result;
}

}  // namespace screed::avr_stack
