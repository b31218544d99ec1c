// Calls avrdude 7 and turns what it says into one line. Knows no USB and no touch.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/flash/child_process.h"
#include "tools/flash/fuses.h"

namespace screed::flash {

struct Avrdude {
  std::string program = "avrdude";
  std::string mcu;         ///< avrdude's name of the part: "atmega32u4"
  std::string programmer;  ///< its -c: "avr109" is the bootloader
  std::string port;        ///< its -P; empty: the programmer's own (an ISP programmer on USB)
  /// avrdude waits 5 s for an answer of the bootloader, and erasing the chip takes 2 s.
  std::chrono::milliseconds idle_timeout{8000};
  bool show_output = false;
};

/// The bootloader's name among avrdude's programmers.
inline constexpr const char* kBootloaderProtocol = "avr109";

/// Erases the application section, writes the Intel HEX file `image` and reads it back. Returns the
/// number of bytes that were verified.
/// The erase comes first so that an interrupted run leaves no mixture of two images: what is
/// missing reads 0xFF, which the processor runs through up to the bootloader. Throws RunError with
/// one line for whatever goes wrong.
unsigned write_flash(const Avrdude& avrdude, const std::filesystem::path& image);

/// Throws RunError as above.
Fuses read_fuses(const Avrdude& avrdude);

/// Writes the fuses, and the lock byte last. Throws RunError as above.
void write_fuses(const Avrdude& avrdude, const Fuses& fuses);

/// The command that writes them, for a person to type.
std::string fuse_command(const Avrdude& avrdude, const Fuses& fuses);

/// The line for a failed call.
std::string failure_message(const Avrdude& avrdude, const ChildOutcome& outcome);

}  // namespace screed::flash
