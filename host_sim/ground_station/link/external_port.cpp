// A simulated robot's radio for other programs.
#include "host_sim/ground_station/link/external_port.h"

namespace screed {

void CanPort::send(std::span<const uint8_t> bytes) {
  CanFrame frame{};
  for (const uint8_t byte : bytes) {
    if (parser_.feed(byte, frame)) link_.send(frame);
  }
}

std::vector<uint8_t> CanPort::receive() {
  frames_.clear();
  link_.receive(std::chrono::milliseconds(0), frames_);
  std::vector<uint8_t> lines;
  for (const LinkFrame& received : frames_) {
    uint8_t line[kSlcanLineMax];
    const uint8_t length = slcan_encode(received.frame, line);
    lines.insert(lines.end(), line, line + length);
  }
  return lines;
}

void PortGroup::send(std::span<const uint8_t> bytes) {
  for (const auto& port : ports_) port->send(bytes);
}

std::vector<uint8_t> PortGroup::receive() {
  std::vector<uint8_t> all;
  for (const auto& port : ports_) {
    const std::vector<uint8_t> bytes = port->receive();
    all.insert(all.end(), bytes.begin(), bytes.end());
  }
  return all;
}

}  // namespace screed
