// A key file is one line of text, that of key_text(): 32 hexadecimal digits of the key, a blank,
// and the robot's id.
#pragma once

#include <filesystem>

#include "host_sim/ground_station/station/command_key.h"

namespace screed {

/// Throws InputError when the file cannot be read, or others may read it (its mode must be 0600 or
/// 0400).
CommandKey read_key_file(const std::filesystem::path& file);
/// Creates the file with mode 0600, never over one that is there: a key that is lost locks its
/// robot until somebody comes with a USB cable. Throws InputError.
void write_key_file(const std::filesystem::path& file, const CommandKey& key);

}  // namespace screed
