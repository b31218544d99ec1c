// One direction of the XBee link.
#include "host_sim/radio/radio_link.h"

#include <algorithm>

namespace screed {

void RadioLink::send(uint64_t now_us, std::span<const uint8_t> bytes) {
  if (bytes.empty()) return;
  const bool lost = random_.uniform() < options_.loss;
  line_free_us_ = std::max(line_free_us_, static_cast<double>(now_us));
  for (const uint8_t byte : bytes) {
    line_free_us_ += 1e6 / options_.bytes_per_s;
    if (!lost)
      in_flight_.push_back({static_cast<uint64_t>(line_free_us_ + options_.delay_s * 1e6), byte});
  }
}

std::vector<uint8_t> RadioLink::receive(uint64_t now_us, size_t most) {
  std::vector<uint8_t> bytes;
  while (bytes.size() < most) {
    const std::optional<Byte> byte = receive_byte(now_us);
    if (!byte.has_value()) break;
    bytes.push_back(byte->value);
  }
  return bytes;
}

std::optional<RadioLink::Byte> RadioLink::receive_byte(uint64_t now_us) {
  if (in_flight_.empty() || in_flight_.front().arrives_us > now_us) return std::nullopt;
  const Byte byte = in_flight_.front();
  in_flight_.pop_front();
  return byte;
}

}  // namespace screed
