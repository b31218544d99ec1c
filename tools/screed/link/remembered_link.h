// The link and the key file that calls use that name no link: an INI file of the user, written by
// --remember.
//
//   [link]
//   port = /dev/ttyUSB0      or can = slcan0, or pty = /home/ada/radio
//   baud = 57600
//   api = 0
//   key = /home/ada/robot.key
#pragma once

#include <filesystem>
#include <string>

#include "tools/screed/link/link_options.h"

namespace screed {

/// screed/link.ini in the user's folder for configurations: XDG_CONFIG_HOME, else ~/.config. Empty
/// when neither is known.
std::filesystem::path remembered_link_file();

/// What the file says; nothing where there is no file. Throws InputError with file and line.
LinkArguments read_remembered_link(const std::filesystem::path& file);

/// Replaces the file. Names of files become absolute; the key itself is not written. Throws
/// InputError when `file` is empty, RunError when it cannot be written.
void write_remembered_link(const std::filesystem::path& file, const LinkArguments& link);

/// "port /dev/ttyUSB0, key /home/ada/robot.key".
std::string remembered_link_text(const LinkArguments& link);

}  // namespace screed
