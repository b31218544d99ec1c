// A tree like /sys and /dev with USB serial devices in it, and a pty that sees how it is opened.
#pragma once

#include <filesystem>
#include <string>

#include "tests/temp_folder.h"
#include "tools/flash/usb_serial.h"

namespace screed::flash {

/// Folders and links as Linux lays them out for a USB serial device; removed with the object.
class FakeUsb {
 public:
  FakeUsb();

  /// A device in `socket` ("1-1.2") whose port /dev/`tty` is `port`, or no file at all when empty.
  void plug_in(const std::string& socket, UsbId id, const std::string& tty,
               const std::filesystem::path& port = {}, const std::string& product = "");
  void unplug(const std::string& socket, const std::string& tty);

  SystemRoots roots() const { return {folder_ / "sys", folder_ / "dev"}; }
  std::filesystem::path folder() const { return folder_; }
  std::filesystem::path device(const std::string& tty) const { return folder_ / "dev" / tty; }

 private:
  std::filesystem::path socket_folder(const std::string& socket) const;
  TempFolder temporary_;
  std::filesystem::path folder_ = temporary_.path();
};

/// The port of a running sketch: knows at which baud rate it was opened and whether it was closed.
class SketchPort {
 public:
  SketchPort();
  ~SketchPort();
  SketchPort(const SketchPort&) = delete;
  SketchPort& operator=(const SketchPort&) = delete;

  std::filesystem::path port() const { return port_; }
  /// It was opened at 1200 baud with hang-up on close, and nobody has it open any more.
  bool touched() const;
  /// Returns when whoever opened it has closed it.
  void wait_until_closed() const;

 private:
  bool closed(int timeout_ms) const;
  int master_ = -1;
  std::filesystem::path port_;
};

}  // namespace screed::flash
