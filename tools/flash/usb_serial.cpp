#include "tools/flash/usb_serial.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <fstream>
#include <optional>

#include "host_sim/core/errors.h"

namespace screed::flash {
namespace {

namespace fs = std::filesystem;

std::string first_line(const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

/// The folder of the USB device that a tty belongs to: the nearest one above it with an idVendor.
/// (An interface lies between them, and for USB-to-serial chips a port as well.)
std::optional<fs::path> usb_device_of(const fs::path& tty, const fs::path& sys) {
  std::error_code error;
  fs::path folder = fs::canonical(tty / "device", error);
  if (error) return std::nullopt;
  const fs::path top = fs::canonical(sys, error);
  for (; folder != top && folder.has_relative_path(); folder = folder.parent_path())
    if (fs::exists(folder / "idVendor", error)) return folder;
  return std::nullopt;
}

}  // namespace

std::string to_string(UsbId id) {
  char text[10];
  std::snprintf(text, sizeof text, "%04x:%04x", id.vendor, id.product);
  return text;
}

UsbId parse_usb_id(const std::string& text) {
  UsbId id;
  const char* const begin = text.data();
  const bool right = text.size() == 9 && text[4] == ':' &&
                     std::from_chars(begin, begin + 4, id.vendor, 16).ptr == begin + 4 &&
                     std::from_chars(begin + 5, begin + 9, id.product, 16).ptr == begin + 9;
  if (!right)
    throw InputError("USB id '" + text + "': two numbers of four hexadecimal digits, as 1ffb:2300");
  return id;
}

std::vector<UsbSerialPort> usb_serial_ports(const SystemRoots& roots) {
  std::vector<UsbSerialPort> ports;
  std::error_code error;
  for (const auto& tty : fs::directory_iterator(roots.sys / "class" / "tty", error)) {
    const auto device = usb_device_of(tty.path(), roots.sys);
    if (!device) continue;
    const std::string ids =
        first_line(*device / "idVendor") + ":" + first_line(*device / "idProduct");
    try {
      ports.push_back({roots.dev / tty.path().filename(), parse_usb_id(ids),
                       device->filename().string(), first_line(*device / "product")});
    } catch (const InputError&) {
      continue;  // unplugged between the two looks: its files are empty
    }
  }
  std::sort(ports.begin(), ports.end(),
            [](const UsbSerialPort& a, const UsbSerialPort& b) { return a.device < b.device; });
  return ports;
}

std::string to_string(const UsbSerialPort& port) {
  return port.device.string() + " (USB " + to_string(port.id) +
         (port.product.empty() ? "" : ", " + port.product) + ")";
}

}  // namespace screed::flash
