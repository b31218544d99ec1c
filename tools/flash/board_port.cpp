#include "tools/flash/board_port.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <optional>

#include "host_sim/core/errors.h"
#include "tools/flash/serial_touch.h"

namespace screed::flash {
namespace {

namespace fs = std::filesystem;

constexpr const char* kResetTwice =
    "press its reset button twice within 750 ms (its yellow LED then fades in and out for 8 s) and "
    "try "
    "again";

std::string listed(const std::vector<UsbSerialPort>& ports) {
  std::string text;
  for (const auto& port : ports) text += (text.empty() ? "" : ", ") + to_string(port);
  return text.empty() ? "none" : text;
}

BoardPort board_port(const UsbSerialPort& port, const BoardUsb& usb) {
  return {port.device, port.socket, port.id == usb.bootloader};
}

bool is_board(const UsbSerialPort& port, const BoardUsb& usb) {
  return port.id == usb.sketch || port.id == usb.bootloader;
}

BoardPort port_asked_for(const SystemRoots& roots, const BoardUsb& usb, const std::string& name) {
  const auto ports = usb_serial_ports(roots);
  std::error_code error;
  // Names may be links (/dev/serial/by-id/...).
  const fs::path asked_for = fs::canonical(name, error);
  if (error)
    throw InputError("PORT=" + name + " does not exist; serial ports on USB: " + listed(ports));
  const auto port = std::find_if(ports.begin(), ports.end(), [&](const UsbSerialPort& candidate) {
    return fs::canonical(candidate.device, error) == asked_for;
  });
  if (port == ports.end()) return {name, "", true};
  if (!is_board(*port, usb))
    throw InputError("PORT=" + name + " is " + to_string(*port) + ", not the board, which is USB " +
                     to_string(usb.sketch) + " or, in its bootloader, " +
                     to_string(usb.bootloader));
  return board_port(*port, usb);
}

/// The port with this id in this socket.
std::optional<UsbSerialPort> in_socket(const SystemRoots& roots, const std::string& socket,
                                       UsbId id) {
  for (auto& port : usb_serial_ports(roots))
    if (port.socket == socket && port.id == id) return port;
  return std::nullopt;
}

}  // namespace

BoardPort find_board(const SystemRoots& roots, const BoardUsb& usb, const std::string& asked_for) {
  if (!asked_for.empty()) return port_asked_for(roots, usb, asked_for);
  const auto ports = usb_serial_ports(roots);
  std::vector<UsbSerialPort> boards;
  std::copy_if(ports.begin(), ports.end(), std::back_inserter(boards),
               [&](const UsbSerialPort& port) { return is_board(port, usb); });
  if (boards.empty())
    throw RunError("no board found: looked for USB " + to_string(usb.sketch) +
                   " and, in its bootloader, " + to_string(usb.bootloader) +
                   " among the serial ports on USB: " + listed(ports) + "; if it is plugged in, " +
                   kResetTwice);
  if (boards.size() > 1)
    throw RunError("several boards found, choose one with PORT=...: " + listed(boards));
  return board_port(boards.front(), usb);
}

fs::path bootloader_port(const BoardPort& board, const SystemRoots& roots, const BoardUsb& usb,
                         const Timeouts& timeouts, const Clock& clock,
                         const std::function<void(const std::string&)>& tell) {
  if (board.in_bootloader) return board.device;
  fs::path closed_to_us;
  for (int touch = 0; touch < timeouts.touches; ++touch) {
    // A reset may have given the sketch's port another name; while it is away there is only
    // waiting.
    if (const auto sketch = in_socket(roots, board.socket, usb.sketch)) {
      tell("restarting " + sketch->device.string() + " in its bootloader");
      touch_at_1200_baud(sketch->device);
    }
    const auto end = clock.now() + timeouts.after_touch;
    do {
      if (const auto found = in_socket(roots, board.socket, usb.bootloader)) {
        // The kernel shows a port a moment before udev has given it its rights.
        if (access(found->device.c_str(), R_OK | W_OK) == 0) return found->device;
        if (errno == EACCES) closed_to_us = found->device;
      }
      clock.pause(timeouts.between_looks);
    } while (clock.now() < end);
  }
  if (!closed_to_us.empty()) throw RunError(no_right_to_open(closed_to_us));
  throw RunError("no bootloader: " + board.device.string() + " was opened at 1200 baud " +
                 std::to_string(timeouts.touches) + " times, but no USB " +
                 to_string(usb.bootloader) + " came up in its place; " + kResetTwice);
}

}  // namespace screed::flash
