// The serial ports of this machine.
#include "host_sim/ground_station/link/serial_link.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <thread>

#include "host_sim/core/errors.h"
#include "host_sim/core/name_list.h"

namespace screed {

std::vector<std::string> serial_ports(const std::filesystem::path& devices) {
  // Not ttyS: the kernel makes four of them, whether there is a line behind or not.
  constexpr const char* kKinds[] = {"ttyACM", "ttyAMA", "ttyUSB", "rfcomm"};
  std::vector<std::string> ports;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(devices, error)) {
    const std::string name = entry.path().filename().string();
    const bool is_port = std::any_of(std::begin(kKinds), std::end(kKinds),
                                     [&](const char* kind) { return name.rfind(kind, 0) == 0; });
    if (is_port) ports.push_back(entry.path().string());
  }
  std::sort(ports.begin(), ports.end());
  return ports;
}

std::string no_such_port(const std::filesystem::path& devices) {
  const std::vector<std::string> ports = serial_ports(devices);
  return "no such port; serial ports here: " + (ports.empty() ? "none" : name_list(ports));
}

// A radio module on a serial port.

namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kSerialLookAgain{500};
// As slcand sends them. By radio robots ignore them.
constexpr std::string_view kSlcanOpen = "\rO\r";
constexpr std::string_view kSlcanClose = "\rC\r";
// Of a console; its longest line is half of that.
constexpr size_t kMaxAnswer = 100;

speed_t speed_of(int baud) {
  switch (baud) {
    case 9600:
      return B9600;
    case 19200:
      return B19200;
    case 38400:
      return B38400;
    case 57600:
      return B57600;
    case 115200:
      return B115200;
    case 230400:
      return B230400;
    default:
      throw InputError("baud rate " + std::to_string(baud) +
                       ": expected 9600, 19200, 38400, 57600, 115200 or 230400");
  }
}

/// Raw bytes, 8N1, no flow control. The last character read may end a wait.
bool set_up(int port, speed_t speed) {
  termios settings{};
  if (tcgetattr(port, &settings) != 0) return false;
  cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(CSTOPB | CRTSCTS | HUPCL);
  settings.c_cc[VMIN] = 0;
  settings.c_cc[VTIME] = 0;
  cfsetspeed(&settings, speed);
  return tcsetattr(port, TCSANOW, &settings) == 0;
}

std::optional<fs::path> lasting_name_of(const fs::path& device, const fs::path& by_id) {
  std::error_code error;
  const fs::path target = fs::canonical(device, error);
  if (error) return std::nullopt;
  for (const auto& entry : fs::directory_iterator(by_id, error)) {
    std::error_code broken;
    if (fs::canonical(entry.path(), broken) == target && !broken) return entry.path();
  }
  return std::nullopt;
}

}  // namespace

ApiGuess::ApiGuess(std::optional<XbeeApiMode> chosen) : chosen_(chosen) {
  using Mode = std::optional<XbeeApiMode>;
  for (const Mode mode : {Mode(), Mode(XbeeApiMode::kPlain), Mode(XbeeApiMode::kEscaped)}) {
    if (mode != chosen)
      others_.push_back({mode, XbeeApiParser(mode.value_or(XbeeApiMode::kPlain))});
  }
}

std::string ApiGuess::feed(std::span<const uint8_t> bytes, uint64_t received) {
  constexpr uint64_t kEnough = 10;  // frames of the chosen setting: nothing to guess any more
  constexpr uint64_t kSure = 3;
  constexpr uint64_t kBytesOfNoise = 1000;
  if (received >= kEnough) return "";
  bytes_ += bytes.size();
  for (const uint8_t byte : bytes) {
    const bool of_text = (byte >= ' ' && byte <= '~') || byte == '\r' || byte == '\n';
    odd_bytes_ += of_text ? 0 : 1;
  }
  for (Reading& other : others_) {
    CanFrame frame{};
    std::vector<XbeeFrame> packets;
    for (const uint8_t byte : bytes) {
      if (other.mode.has_value()) {
        other.packets.feed(byte, packets);
      } else {
        other.found += other.lines.feed(byte, frame) ? 1 : 0;
      }
    }
    for (const XbeeFrame& packet : packets) other.found += received_packet(packet) ? 1 : 0;
    if (other.found < kSure || other.found <= received) continue;
    if (!other.mode.has_value())
      return "lines of a transparent module come in: leave out --api, or set the module's AP to 1";
    return *other.mode == XbeeApiMode::kPlain ? "packets of API mode 1 come in: --api 1 reads them"
                                              : "packets of API mode 2 come in: --api 2 reads them";
  }
  if (received == 0 && bytes_ >= kBytesOfNoise && 4 * odd_bytes_ > bytes_)
    return "bytes come in that are no lines: does --baud fit the module?";
  return "";
}

SerialLink::SerialLink(const fs::path& device, const SerialOptions& options)
    : options_(options), name_(device.string()), guess_(options.api) {
  speed_of(options.baud);
  if (options.api.has_value()) api_.emplace(*options.api);
  open_port(device);
}

void SerialLink::open_port(const fs::path& device) {
  const std::string text = device.string();
  FileDescriptor port(open(device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!port.is_open()) {
    const int reason = errno;
    if (reason == ENOENT) throw InputError(text + ": " + no_such_port(options_.devices));
    if (reason == EACCES || reason == EPERM) {
      throw RunError(text + ": no right to open it: join the group dialout (docs/link.md)");
    }
    if (reason == EBUSY) throw RunError(text + ": another program holds it");
    throw RunError(text + ": cannot be opened: " + std::strerror(reason));
  }
  if (isatty(port.get()) == 0) throw InputError(text + ": not a serial port");
  if (flock(port.get(), LOCK_EX | LOCK_NB) != 0)
    throw RunError(text + ": another program holds it");
  ioctl(port.get(), TIOCEXCL);
  if (!set_up(port.get(), speed_of(options_.baud)))
    throw RunError(text + ": cannot be set up: " + std::strerror(errno));
  tcflush(port.get(), TCIFLUSH);
  port_ = std::move(port);
  lasting_name_ = lasting_name_of(device, options_.by_id);
  status_.up = true;
  status_.text = "up";
  send_text(kSlcanOpen);
}

void SerialLink::lost(const char* why) {
  port_.reset();
  parsers_.clear();
  if (options_.api.has_value()) api_.emplace(*options_.api);
  status_.up = false;
  status_.text = why;
  ++status_.interruptions;
  looked_at_ = std::chrono::steady_clock::now();
}

void SerialLink::look_for_port() {
  looked_at_ = std::chrono::steady_clock::now();
  const std::optional<fs::path> lasting = lasting_name_;
  for (const fs::path& device : {lasting.value_or(name_), fs::path(name_)}) {
    try {
      open_port(device);
      return;
    } catch (const std::runtime_error& error) {
      status_.text = std::string("waiting for it to come back (") + error.what() + ")";
    }
  }
}

void SerialLink::receive(std::chrono::milliseconds wait, std::vector<LinkFrame>& frames) {
  if (!port_.is_open()) {
    if (std::chrono::steady_clock::now() - looked_at_ >= kSerialLookAgain) look_for_port();
    if (!port_.is_open()) {
      std::this_thread::sleep_for(std::min(wait, kSerialLookAgain));
      return;
    }
  }
  const Readiness ready = wait_readable(port_.get(), wait);
  if (ready == Readiness::kBroken) return lost("gone; waiting for it to come back");
  if (ready == Readiness::kNothing) return;
  std::array<uint8_t, 4096> bytes;
  const ssize_t count = read(port_.get(), bytes.data(), bytes.size());
  if (count > 0) {
    const std::span<const uint8_t> read = std::span(bytes).first(static_cast<size_t>(count));
    process(read, frames);
    status_.hint = guess_.feed(read, status_.received);
  } else if (count == 0 || (errno != EAGAIN && errno != EINTR)) {
    lost("gone; waiting for it to come back");
  }
}

void SerialLink::process(std::span<const uint8_t> bytes, std::vector<LinkFrame>& frames) {
  const uint64_t now_us = wall_clock_us();
  if (!api_.has_value()) return take_lines(bytes, now_us, std::nullopt, frames);
  std::vector<XbeeFrame> packets;
  const uint64_t refused = api_->refused();
  for (const uint8_t byte : bytes) api_->feed(byte, packets);
  status_.refused += api_->refused() - refused;
  for (const XbeeFrame& packet : packets) process(packet, now_us, frames);
}

void SerialLink::process(const XbeeFrame& frame, uint64_t now_us, std::vector<LinkFrame>& frames) {
  if (const auto packet = received_packet(frame)) {
    heard_type_ = frame.type;
    if (packet->source.rssi_dbm.has_value()) status_.rssi_dbm = packet->source.rssi_dbm;
    take_lines(packet->data, now_us, packet->source, frames);
  } else if (const auto rssi_dbm = answered_rssi_dbm(frame)) {
    status_.rssi_dbm = rssi_dbm;
  } else if (delivered(frame) == false) {
    ++status_.errors;
  }
}

void SerialLink::take_lines(std::span<const uint8_t> bytes, uint64_t now_us,
                            const std::optional<RadioSource>& source,
                            std::vector<LinkFrame>& frames) {
  SlcanParser& parser = parsers_[source.has_value() ? source->address : 0];
  CanFrame frame{};
  for (const uint8_t byte : bytes) {
    const uint8_t before = parser.rejected();
    if (parser.feed(byte, frame)) {
      frames.push_back({now_us, frame, source});
      ++status_.received;
    }
    status_.refused += static_cast<uint8_t>(parser.rejected() - before);
    // Lines of the radio end in \r, those of a console in \n.
    if (byte == '\n') answer_ = line_;
    if (byte == '\n' || byte == '\r') {
      line_.clear();
    } else if (line_.size() < kMaxAnswer) {
      line_ += static_cast<char>(byte);
    }
  }
}

// A line is taken whole or not at all: part of one would spoil the next.
bool SerialLink::write_whole(std::span<const uint8_t> bytes) {
  size_t done = 0;
  for (int attempt = 0; port_.is_open() && done < bytes.size() && attempt < 50; ++attempt) {
    const ssize_t count = write(port_.get(), bytes.data() + done, bytes.size() - done);
    if (count > 0) {
      done += static_cast<size_t>(count);
    } else if (errno == EAGAIN || errno == EINTR) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    } else {
      lost("gone; waiting for it to come back");
    }
  }
  return done == bytes.size();
}

bool SerialLink::send(const CanFrame& frame) {
  uint8_t line[kSlcanLineMax];
  const std::span<const uint8_t> text(line, slcan_encode(frame, line));
  const bool sent =
      options_.api.has_value()
          ? write_whole(encode_xbee(broadcast_request(text, heard_type_), *options_.api))
          : write_whole(text);
  ++(sent ? status_.sent : status_.not_sent);
  return sent;
}

bool SerialLink::send_text(std::string_view text) {
  return !options_.api.has_value() &&
         write_whole({reinterpret_cast<const uint8_t*>(text.data()), text.size()});
}

// Of a board's USB the lines of the radio have to be asked for, and end with whoever asked.
SerialLink::~SerialLink() {
  send_text(kSlcanClose);
}

}  // namespace screed
