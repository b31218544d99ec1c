#include "tools/flash/avrdude.h"

#include <cctype>
#include <iostream>
#include <sstream>

#include "host_sim/core/errors.h"
#include "tools/flash/serial_touch.h"

namespace screed::flash {
namespace {

using Words = std::vector<std::string>;

// avrdude 7.1 does not stop at this line: it tries the rest byte by byte, 5 s each.
constexpr const char* kNoAnswer = "programmer is not responding";

Words call(const Avrdude& avrdude, const Words& operations) {
  Words words = {avrdude.program, "-p", avrdude.mcu, "-c", avrdude.programmer};
  if (!avrdude.port.empty()) words.insert(words.end(), {"-P", avrdude.port});
  // USB has no baud rate; the number is what Caterina is documented with.
  if (avrdude.programmer == kBootloaderProtocol) words.insert(words.end(), {"-b", "57600"});
  words.insert(words.end(), operations.begin(), operations.end());
  return words;
}

bool contains(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

std::string run(const Avrdude& avrdude, const Words& operations) {
  std::size_t shown = 0;
  const auto outcome =
      run_child(call(avrdude, operations), avrdude.idle_timeout, [&](std::string_view said) {
        if (avrdude.show_output) std::cerr << said.substr(shown) << std::flush;
        shown = said.size();
        return !contains(said, kNoAnswer);
      });
  if (outcome.killed || outcome.exit_code != 0) throw RunError(failure_message(avrdude, outcome));
  return outcome.said;
}

/// What follows the first `marker` on its line; empty without one.
std::string line_after(const std::string& text, const std::string& marker) {
  const auto at = text.find(marker);
  if (at == std::string::npos) return "";
  const auto begin = at + marker.size();
  return text.substr(begin, text.find_first_of("\r\n", begin) - begin);
}

/// Its first word.
std::string word_after(const std::string& text, const std::string& marker) {
  const std::string line = line_after(text, marker);
  return line.substr(0, line.find(' '));
}

/// "1e9488" as "1E 94 88", which is how avrdude writes the signature it expects.
std::string spaced(const std::string& digits) {
  std::string text;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && i % 2 == 0) text += ' ';
    text += static_cast<char>(std::toupper(static_cast<unsigned char>(digits[i])));
  }
  return text;
}

/// Its first complaint, without the "avrdude error: " before it.
std::string first_error(const std::string& said) {
  const bool warned_first = said.find("warning: ") < said.find("error: ");
  return line_after(said, warned_first ? "warning: " : "error: ");
}

/// The line for a chip with another signature; empty when that is not what happened.
std::string wrong_chip(const std::string& said) {
  const std::string expected = line_after(said, "expected signature for ");  // "PART is 1E 95 87"
  const auto middle = expected.find(" is ");
  if (middle == std::string::npos) return "";
  return "wrong chip: its signature is " + spaced(word_after(said, "signature = 0x")) +
         ", that of an " + expected.substr(0, middle) + " is " + expected.substr(middle + 4) +
         "; nothing was written";
}

/// The same for a byte that reads back differently, of which avrdude says
/// "device 0xff != input 0x58 at addr 0x0123".
std::string wrong_byte(const std::string& said) {
  const auto at = said.find(" at addr ");
  if (at == std::string::npos) return "";
  const std::string line = said.substr(said.rfind('\n', at) + 1);
  return "verification failed at address " + word_after(line, " at addr ") + ": the board has " +
         word_after(line, "device ") + ", the image " + word_after(line, "input ") +
         "; do not let this image drive, flash again";
}

Words fuse_operations(const Fuses& fuses) {
  Words words;
  for (const auto& fuse : kFuseBytes) {
    words.emplace_back("-U");
    words.push_back(std::string(fuse.avrdude_name) + ":w:" + hex_byte(fuses.*fuse.member) + ":m");
  }
  return words;
}

}  // namespace

std::string failure_message(const Avrdude& avrdude, const ChildOutcome& outcome) {
  const std::string& said = outcome.said;
  for (const auto& line : {wrong_chip(said), wrong_byte(said)})
    if (!line.empty()) return line;

  if (outcome.killed || contains(said, kNoAnswer))
    return "no answer from " + (avrdude.port.empty() ? avrdude.programmer : avrdude.port) +
           (contains(said, "erasing chip")
                ? " half-way: the image on the board is incomplete; reset it twice and flash again"
                : " to avrdude's first questions: is it a bootloader, and still running (8 s)?");

  if (contains(said, "cannot open port")) {
    if (contains(said, "Permission denied")) return no_right_to_open(avrdude.port);
    if (contains(said, "busy")) return port_in_use(avrdude.port);
  }
  const std::string error = first_error(said);
  return avrdude.program +
         " failed: " + (error.empty() ? "exit code " + std::to_string(outcome.exit_code) : error);
}

unsigned write_flash(const Avrdude& avrdude, const std::filesystem::path& image) {
  const std::string said = run(avrdude, {"-e", "-U", "flash:w:" + image.string() + ":i"});
  const auto end = said.find(" bytes of flash verified");
  if (end == std::string::npos || end == 0)
    throw RunError(avrdude.program + " did not say that it verified the image");
  const auto begin = said.find_last_not_of("0123456789", end - 1) + 1;
  return static_cast<unsigned>(std::stoul(said.substr(begin, end - begin)));
}

Fuses read_fuses(const Avrdude& avrdude) {
  Words words = {"-qq"};
  for (const auto& fuse : kFuseBytes) {
    words.emplace_back("-U");
    words.push_back(std::string(fuse.avrdude_name) + ":r:-:h");
  }
  std::istringstream said(run(avrdude, words));  // a line each, in the order of asking
  Fuses fuses;
  for (const auto& fuse : kFuseBytes) {
    std::string value;
    said >> value;
    try {
      fuses.*fuse.member = parse_hex_byte(value, fuse.name);
    } catch (const InputError&) {
      throw RunError(avrdude.program + " did not report the " + fuse.name + " fuse");
    }
  }
  return fuses;
}

void write_fuses(const Avrdude& avrdude, const Fuses& fuses) {
  run(avrdude, fuse_operations(fuses));
}

std::string fuse_command(const Avrdude& avrdude, const Fuses& fuses) {
  std::string text;
  for (const auto& word : call(avrdude, fuse_operations(fuses)))
    text += (text.empty() ? "" : " ") + word;
  return text;
}

}  // namespace screed::flash
