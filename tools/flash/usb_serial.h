// The serial ports of USB devices, as the kernel lists them in sysfs. Knows no board.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace screed::flash {

/// Where the kernel shows its devices; a test hands in a tree of its own.
struct SystemRoots {
  std::filesystem::path sys = "/sys";
  std::filesystem::path dev = "/dev";
};

struct UsbId {
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  bool operator==(const UsbId&) const = default;
};

/// "1ffb:2300", as lsusb writes it.
std::string to_string(UsbId id);

/// The inverse. Throws InputError for anything but four hexadecimal digits, a colon and four more.
UsbId parse_usb_id(const std::string& text);

struct UsbSerialPort {
  std::filesystem::path device;  ///< "/dev/ttyACM0"
  UsbId id;
  /// The socket the device is plugged into, in the kernel's words: "1-1.2". It stays when the
  /// device resets and comes back with other ids or as another tty.
  std::string socket;
  std::string product;  ///< what the device calls itself; may be empty
};

/// Sorted by device. A tty that is not on USB is left out; so is one that vanishes meanwhile.
std::vector<UsbSerialPort> usb_serial_ports(const SystemRoots& roots);

/// "/dev/ttyACM0 (USB 1ffb:2300, Pololu A-Star 32U4)"
std::string to_string(const UsbSerialPort& port);

}  // namespace screed::flash
