// The touch: how a sketch with the Arduino core is made to restart in its bootloader.
#pragma once

#include <filesystem>
#include <string>

namespace screed::flash {

/// Opens the port at 1200 baud, lowers DTR and closes it. The core's CDC.cpp then starts a watchdog
/// of 120 ms that resets the board into its bootloader.
/// Throws RunError when the port may not be opened (rights, in use). A port that vanishes on the
/// way is no error: that is what a touch does.
void touch_at_1200_baud(const std::filesystem::path& device);

/// The lines for a port that this user may not open, and for one that somebody else holds.
std::string no_right_to_open(const std::filesystem::path& device);
std::string port_in_use(const std::filesystem::path& device);

}  // namespace screed::flash
