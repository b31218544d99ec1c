// A channel on which CAN frames travel between this machine and robots: SocketCAN, a radio module
// on a serial port. Frames in and out with their times, and the state of the channel. Knows nothing
// of what the frames mean.
//
// A link survives what happens to links: a stick that is pulled and put back, an interface that is
// taken down, a bus that is off. receive() and send() then do nothing, status() says why, and the
// link goes on by itself as soon as it can.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/protocol/slcan.h"

namespace screed {

/// The radio module that sent a frame, where the link knows it (XBee in API mode).
struct RadioSource {
  uint64_t address = 0;         ///< 64 bits, or 16 of a module that shows no more
  std::optional<int> rssi_dbm;  ///< strength of the last hop
};

struct LinkFrame {
  uint64_t time_us = 0;  ///< since 1970: of the kernel for SocketCAN, else of the reading
  CanFrame frame{};
  std::optional<RadioSource> source;
};

struct LinkStatus {
  bool up = false;
  std::string text = "not open";     ///< in words: "up", or what is wrong
  std::string hint = {};             ///< what comes looks like another setting; empty: it does not
  uint64_t received = 0;             ///< frames
  uint64_t sent = 0;                 ///< frames
  uint64_t not_sent = 0;             ///< frames that the link did not take
  uint64_t refused = 0;              ///< lines or packets that were none, or damaged
  uint64_t errors = 0;               ///< error frames of the bus, failed transmissions of the radio
  uint64_t dropped = 0;              ///< frames this machine was too slow to take
  uint64_t interruptions = 0;        ///< how often the link was lost
  std::optional<int> rssi_dbm = {};  ///< of the newest frame
};

class Link {
 public:
  Link() = default;
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;
  virtual ~Link() = default;

  /// Appends what has arrived; waits for the first frame at most this long. Frames stay in order.
  virtual void receive(std::chrono::milliseconds wait, std::vector<LinkFrame>& frames) = 0;
  /// False when the link did not take the frame; it is then lost, and counted in status().not_sent.
  virtual bool send(const CanFrame& frame) = 0;
  virtual const LinkStatus& status() const = 0;
  /// What the link is called: "vcan0", "/dev/ttyUSB0".
  virtual const std::string& name() const = 0;
};

/// Microseconds since 1970 by this machine's clock.
uint64_t wall_clock_us();

}  // namespace screed
