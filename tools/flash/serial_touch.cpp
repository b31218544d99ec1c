#include "tools/flash/serial_touch.h"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "host_sim/core/errors.h"

namespace screed::flash {

std::string no_right_to_open(const std::filesystem::path& device) {
  return "no right to open " + device.string() +
         ": install the udev rule tools/flash/60-screed.rules (docs/flashing.md) and plug the "
         "board in "
         "again";
}

std::string port_in_use(const std::filesystem::path& device) {
  return device.string() + " is in use: end the serial monitor (or ModemManager) that holds it";
}

void touch_at_1200_baud(const std::filesystem::path& device) {
  const int port = open(device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (port < 0) {
    if (errno == EACCES || errno == EPERM) throw RunError(no_right_to_open(device));
    if (errno == EBUSY) throw RunError(port_in_use(device));
    if (errno == ENOENT || errno == ENODEV || errno == ENXIO || errno == EIO) return;
    throw RunError("cannot open " + device.string() + ": " + std::strerror(errno));
  }
  termios settings{};
  if (tcgetattr(port, &settings) == 0) {
    cfsetspeed(&settings, B1200);
    settings.c_cflag |= HUPCL;  // the kernel lowers DTR at the last close
    tcsetattr(port, TCSANOW, &settings);
    // And here, for a port that another program keeps open: then ours is not the last close.
    int dtr = TIOCM_DTR;
    ioctl(port, TIOCMBIC, &dtr);
  }
  close(port);
}

}  // namespace screed::flash
