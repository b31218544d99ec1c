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

class UsbHost {
 public:
  explicit UsbHost(Mcu& mcu) : mcu_(mcu) {}

  /// Plugs the cable in: bus reset, address, configuration. False when the device does not answer.
  bool plug_in();
  /// Pulls the cable out: no frames any more, and nothing is fetched.
  void pull_out() { plugged_ = false; }
  /// Opens or closes the serial line. False when the device does not answer.
  bool set_line(std::uint32_t baud, bool open);
  /// The device descriptor; empty when the device does not answer.
  std::vector<std::uint8_t> device_descriptor();

  /// Sends characters to the device's program.
  bool send(const std::string& text);
  /// Runs for a time without fetching anything.
  void run_ms(double ms);
  /// Runs for a time and returns what the program has sent meanwhile.
  std::string listen_ms(double ms);

 private:
  using Setup = std::array<std::uint8_t, 8>;
  bool setup(const Setup& request);
  bool write(std::uint8_t endpoint, std::vector<std::uint8_t> bytes);
  bool read(std::uint8_t endpoint, std::vector<std::uint8_t>& bytes, double patience_ms);

  void run_step();

  Mcu& mcu_;
  bool plugged_ = false;
  double next_frame_ms_ = 0;
};

}  // namespace screed::mcu
