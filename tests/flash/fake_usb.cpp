#include "tests/flash/fake_usb.h"

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <fstream>
#include <stdexcept>

namespace screed::flash {
namespace {

namespace fs = std::filesystem;

void write_line(const fs::path& file, const std::string& line) {
  std::ofstream(file) << line << "\n";
}

}  // namespace

FakeUsb::FakeUsb() {
  fs::create_directories(folder_ / "sys/class/tty");
  fs::create_directories(folder_ / "dev");
  // What else every machine has: the USB host itself, and a UART that is not on USB.
  fs::create_directories(folder_ / "sys/devices/usb1");
  write_line(folder_ / "sys/devices/usb1/idVendor", "1d6b");
  write_line(folder_ / "sys/devices/usb1/idProduct", "0002");
  const fs::path uart = folder_ / "sys/devices/platform/serial8250/tty/ttyS0";
  fs::create_directories(uart);
  fs::create_directory_symlink("../../../serial8250", uart / "device");
  fs::create_directory_symlink(uart, folder_ / "sys/class/tty/ttyS0");
}

fs::path FakeUsb::socket_folder(const std::string& socket) const {
  return folder_ / "sys/devices/usb1" / socket;
}

void FakeUsb::plug_in(const std::string& socket, UsbId id, const std::string& tty,
                      const fs::path& port, const std::string& product) {
  const fs::path device = socket_folder(socket);
  const fs::path interface = device / (socket + ":1.0");
  const fs::path node = interface / "tty" / tty;
  fs::create_directories(node);
  const std::string ids = to_string(id);
  write_line(device / "idVendor", ids.substr(0, 4));
  write_line(device / "idProduct", ids.substr(5));
  if (!product.empty()) write_line(device / "product", product);
  fs::create_directory_symlink(interface, node / "device");
  if (!port.empty()) fs::create_symlink(port, folder_ / "dev" / tty);
  // Last: what makes it visible.
  fs::create_directory_symlink(node, folder_ / "sys/class/tty" / tty);
}

void FakeUsb::unplug(const std::string& socket, const std::string& tty) {
  fs::remove(folder_ / "sys/class/tty" / tty);
  fs::remove(folder_ / "dev" / tty);
  fs::remove_all(socket_folder(socket));
}

SketchPort::SketchPort() {
  master_ = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (master_ < 0 || grantpt(master_) != 0 || unlockpt(master_) != 0)
    throw std::runtime_error("no pty");
  port_ = ptsname(master_);
}

SketchPort::~SketchPort() {
  close(master_);
}

bool SketchPort::closed(int timeout_ms) const {
  pollfd wait{master_, 0, 0};
  return poll(&wait, 1, timeout_ms) == 1 && (wait.revents & POLLHUP) != 0;
}

void SketchPort::wait_until_closed() const {
  closed(-1);
}

bool SketchPort::touched() const {
  termios settings{};
  // On Linux the master shows the settings of the other side.
  return tcgetattr(master_, &settings) == 0 && cfgetospeed(&settings) == B1200 &&
         (settings.c_cflag & HUPCL) != 0 && closed(0);
}

}  // namespace screed::flash
