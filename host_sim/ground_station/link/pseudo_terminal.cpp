// Waiting for a file descriptor.
#include "host_sim/ground_station/link/pseudo_terminal.h"

#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "host_sim/core/errors.h"

namespace screed {

Readiness wait_readable(int descriptor, std::chrono::milliseconds wait) {
  pollfd entry{descriptor, POLLIN, 0};
  const int ready = poll(&entry, 1, static_cast<int>(wait.count()));
  if (ready <= 0) return Readiness::kNothing;  // also a signal: the caller comes back
  if ((entry.revents & POLLIN) != 0) return Readiness::kReadable;
  return Readiness::kBroken;
}

// A virtual serial port.

namespace {

namespace fs = std::filesystem;

void make_link(const fs::path& link, const fs::path& device) {
  std::error_code error;
  if (fs::is_symlink(link, error) && !fs::exists(link, error)) fs::remove(link, error);
  fs::create_symlink(device, link, error);
  if (error)
    throw InputError(link.string() + ": cannot be made a link to the port: " + error.message());
}

}  // namespace

PseudoTerminal::PseudoTerminal(const std::optional<fs::path>& link)
    : master_(posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
  std::array<char, 64> name{};
  if (!master_.is_open() || grantpt(master_.get()) != 0 || unlockpt(master_.get()) != 0 ||
      ptsname_r(master_.get(), name.data(), name.size()) != 0) {
    throw RunError(std::string("no pseudo terminal: ") + std::strerror(errno));
  }
  device_ = name.data();
  slave_ = FileDescriptor(open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC));
  termios settings{};
  if (!slave_.is_open() || tcgetattr(slave_.get(), &settings) != 0)
    throw RunError(device_.string() + ": cannot be opened: " + std::strerror(errno));
  cfmakeraw(&settings);
  cfsetspeed(&settings, B57600);
  tcsetattr(slave_.get(), TCSANOW, &settings);
  if (link.has_value()) {
    make_link(*link, device_);
    link_ = link;
  }
}

PseudoTerminal::~PseudoTerminal() {
  if (!link_.has_value()) return;
  std::error_code error;
  if (fs::read_symlink(*link_, error) == device_) fs::remove(*link_, error);
}

std::vector<uint8_t> PseudoTerminal::read() {
  std::vector<uint8_t> all;
  std::array<uint8_t, 1024> bytes;
  for (;;) {
    const ssize_t count = ::read(master_.get(), bytes.data(), bytes.size());
    if (count <= 0) return all;
    all.insert(all.end(), bytes.begin(), bytes.begin() + count);
  }
}

void PseudoTerminal::write(std::span<const uint8_t> bytes) {
  if (torn_) bytes = after_line(bytes);
  bool emptied = false;
  while (!bytes.empty()) {
    const ssize_t count = ::write(master_.get(), bytes.data(), bytes.size());
    if (count > 0) {
      mid_line_ = bytes[static_cast<size_t>(count) - 1] != '\r';
      bytes = bytes.subspan(static_cast<size_t>(count));
    } else if (!emptied && errno == EAGAIN) {
      tcflush(slave_.get(), TCIFLUSH);
      emptied = true;
      // What the program has of the line that was thrown away must not be joined to another one.
      const char end = '\r';
      if (::write(master_.get(), &end, 1) != 1) return;
      if (mid_line_) bytes = after_line(bytes);
    } else {
      return;
    }
  }
}

/// What follows the line that `bytes` starts in. Remembers whether that line goes on.
std::span<const uint8_t> PseudoTerminal::after_line(std::span<const uint8_t> bytes) {
  const auto end = std::find(bytes.begin(), bytes.end(), '\r');
  torn_ = end == bytes.end();
  return torn_ ? std::span<const uint8_t>() : std::span(end + 1, bytes.end());
}

}  // namespace screed
