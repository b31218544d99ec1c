// A radio module or a robot behind a serial port.
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host_sim/ground_station/link/link.h"
#include "host_sim/ground_station/link/pseudo_terminal.h"
#include "host_sim/ground_station/link/xbee_api.h"

namespace screed {

// The serial ports of this machine that a radio module or a robot may be behind, for messages about
// one that is not there.

/// USB adapters and boards, serial lines over Bluetooth and of single-board computers, by name.
/// `devices` holds the device files.
std::vector<std::string> serial_ports(const std::filesystem::path& devices = "/dev");

/// "no such port; serial ports here: /dev/ttyACM0, /dev/ttyUSB0" or "...: none".
std::string no_such_port(const std::filesystem::path& devices = "/dev");

// A radio module on a serial port: SLCAN lines, as they are or in packets of the XBee's API mode.
// Also for the pseudo terminal of a simulation, which looks the same.
//
// A port that vanishes (the USB stick is pulled) is looked for twice a second and taken again,
// under the name it was opened with or, when it has come back as another tty, under the name that
// stays with the stick (/dev/serial/by-id).

struct SerialOptions {
  int baud = 57600;  ///< one the system has a name for: 9600 .. 230400
  std::optional<XbeeApiMode> api;
  /// Where the device files are.
  std::filesystem::path devices = "/dev";
  /// Where udev names devices by what they are.
  std::filesystem::path by_id = "/dev/serial/by-id";
};

/// Reads what comes as it would look with the other settings of `--api`, to name the one that fits.
class ApiGuess {
 public:
  explicit ApiGuess(std::optional<XbeeApiMode> chosen);

  /// received: frames that the chosen setting has found. Returns what to tell the user, or nothing.
  std::string feed(std::span<const uint8_t> bytes, uint64_t received);

 private:
  struct Reading {
    std::optional<XbeeApiMode> mode;
    XbeeApiParser packets;
    SlcanParser lines = {};
    uint64_t found = 0;
  };

  std::optional<XbeeApiMode> chosen_;
  std::vector<Reading> others_;
  uint64_t bytes_ = 0;
  uint64_t odd_bytes_ = 0;  ///< that no text has
};

class SerialLink : public Link {
 public:
  /// Opens the port. Throws InputError when there is none of this name or it is no terminal, or the
  /// baud rate is unknown; RunError when it may not be opened or another program holds it.
  SerialLink(const std::filesystem::path& device, const SerialOptions& options);
  ~SerialLink() override;

  void receive(std::chrono::milliseconds wait, std::vector<LinkFrame>& frames) override;
  bool send(const CanFrame& frame) override;
  /// Text for the console of a board whose USB the port is. False when it was not taken.
  bool send_text(std::string_view text);
  /// The console's newest answer, once; empty when there is none.
  std::string take_answer() { return std::exchange(answer_, {}); }
  const LinkStatus& status() const override { return status_; }
  const std::string& name() const override { return name_; }

 private:
  bool write_whole(std::span<const uint8_t> bytes);
  void open_port(const std::filesystem::path& device);
  void lost(const char* why);
  void look_for_port();
  void process(std::span<const uint8_t> bytes, std::vector<LinkFrame>& frames);
  void process(const XbeeFrame& frame, uint64_t now_us, std::vector<LinkFrame>& frames);
  void take_lines(std::span<const uint8_t> bytes, uint64_t now_us,
                  const std::optional<RadioSource>& source, std::vector<LinkFrame>& frames);

  SerialOptions options_;
  std::string name_;
  std::optional<std::filesystem::path> lasting_name_;
  FileDescriptor port_;
  LinkStatus status_;
  std::chrono::steady_clock::time_point looked_at_;
  std::optional<XbeeApiParser> api_;
  ApiGuess guess_;
  XbeeFrameType heard_type_ = XbeeFrameType::kReceive;
  /// Lines of several robots are distinguished by their modules' addresses; 0 without API mode.
  std::map<uint64_t, SlcanParser> parsers_;
  std::string line_;
  std::string answer_;
};

}  // namespace screed
