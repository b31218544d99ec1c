// Finds the port of the board, and from there the port of its bootloader.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>

#include "tools/flash/clock.h"
#include "tools/flash/usb_serial.h"

namespace screed::flash {

/// What a board is on USB: one id while its sketch runs, another while its bootloader does.
struct BoardUsb {
  UsbId sketch;
  UsbId bootloader;
};

struct BoardPort {
  std::filesystem::path device;
  std::string socket;  ///< see UsbSerialPort; empty for a port that is not on USB
  bool in_bootloader = false;
};

/// Without `asked_for`: the one board that is plugged in. With it: that port; one that is not on
/// USB (a pty, a plain UART) is taken for a bootloader, since nothing can be detected from outside.
/// Throws RunError when no board or several are found, InputError when `asked_for` does not exist
/// or belongs to another USB device.
BoardPort find_board(const SystemRoots& roots, const BoardUsb& usb, const std::string& asked_for);

/// Attempts and timeouts.
struct Timeouts {
  int touches = 3;
  std::chrono::milliseconds after_touch{5000};  ///< reset 0.12 s, enumeration 1 to 2 s
  std::chrono::milliseconds between_looks{50};
};

/// The port of the board's bootloader: the board's own when it is there already, otherwise the one
/// that appears in the same socket after a touch, under whatever name. `tell` gets a line of
/// progress a touch. Throws RunError when none appears, or this user may not open it.
std::filesystem::path bootloader_port(const BoardPort& board, const SystemRoots& roots,
                                      const BoardUsb& usb, const Timeouts& timeouts,
                                      const Clock& clock,
                                      const std::function<void(const std::string&)>& tell);

}  // namespace screed::flash
