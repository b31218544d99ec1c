// A USB host at the microcontroller's port, as far as a serial line needs one: it resets and
// configures the device, opens and closes the line, moves bytes, and starts a frame every
// millisecond, which simavr 1.6 does not.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "host_sim/devices/mcu/mcu.h"

namespace screed::mcu {

/// A request as it travels in the setup stage (USB 2.0, 9.3).
struct UsbRequest {
  std::uint8_t type = 0;  ///< bmRequestType; bit 7: to the host
  std::uint8_t request = 0;
  std::uint16_t value = 0;
  std::uint16_t index = 0;
  std::uint16_t length = 0;
};

class UsbHost {
 public:
  explicit UsbHost(Mcu& mcu) : mcu_(mcu) {}

  /// Plugs the cable in: bus reset, address, configuration. False when the device does not answer.
  bool plug_in();
  /// Pulls the cable out: no frames any more, and nothing is fetched.
  void pull_out() { plugged_ = false; }
  /// Resets the bus.
  void reset();

  /// How far a control transfer got within the times that USB allows (9.2.6.4): 500 ms to a packet
  /// of data, 50 ms to the status stage.
  enum class Outcome { kDone, kStalled, kNoAnswer };
  /// Where the host breaks a transfer off, without another word.
  enum class Until { kEnd, kSetup, kFirstPacket, kStatus };
  Outcome transfer(const UsbRequest& request, std::vector<std::uint8_t>& data,
                   Until until = Until::kEnd);
  /// The answer to a request for `length` bytes; empty when there is none.
  std::vector<std::uint8_t> ask(std::uint8_t type, std::uint8_t request, std::uint16_t value,
                                std::uint16_t length);
  std::vector<std::uint8_t> descriptor(std::uint8_t type, std::uint8_t index, std::uint16_t length);
  /// A request without data.
  Outcome tell(std::uint8_t type, std::uint8_t request, std::uint16_t value,
               std::uint16_t index = 0);

  /// Opens or closes the serial line. False when the device does not answer.
  bool set_line(std::uint32_t baud, bool open);

  /// Sends characters to the device's program.
  bool send(const std::string& text);
  /// Runs for a time without fetching anything.
  void run_ms(double ms);
  /// Runs for a time and returns what the program has sent meanwhile.
  std::string listen_ms(double ms);

 private:
  Outcome write(std::uint8_t endpoint, std::vector<std::uint8_t> bytes, double patience_ms);
  Outcome read(std::uint8_t endpoint, std::vector<std::uint8_t>& bytes, double patience_ms);
  Outcome receive_data(const UsbRequest& request, std::vector<std::uint8_t>& data, Until until);

  void run_step();

  Mcu& mcu_;
  bool plugged_ = false;
  double next_frame_ms_ = 0;
};

}  // namespace screed::mcu
