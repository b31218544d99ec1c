// The serial ports of this machine that a radio module or a robot may be behind, for messages about
// one that is not there.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace screed {

/// USB adapters and boards, serial lines over Bluetooth and of single-board computers, by name.
/// `devices` holds the device files.
std::vector<std::string> serial_ports(const std::filesystem::path& devices = "/dev");

/// "no such port; serial ports here: /dev/ttyACM0, /dev/ttyUSB0" or "...: none".
std::string no_such_port(const std::filesystem::path& devices = "/dev");

}  // namespace screed
