// One direction of the XBee link as a pipe of bytes: rate of the UART, delay, loss of whole
// packets.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "host_sim/core/random.h"

namespace screed {

struct RadioOptions {
  double delay_s = 0.012;       ///< UART to UART
  double loss = 0.0;            ///< probability that a packet is lost, 0..1
  double bytes_per_s = 5760.0;  ///< 57,600 baud, 10 bits a byte
};

class RadioLink {
 public:
  RadioLink(uint64_t seed, std::string_view name, const RadioOptions& options)
      : options_(options), random_(seed, name) {}

  /// Sends one packet: the bytes that were written together.
  void send(uint64_t now_us, std::span<const uint8_t> bytes);

  /// Takes what has arrived by now, at most `most` bytes, in order.
  std::vector<uint8_t> receive(uint64_t now_us, size_t most);

  struct Byte {
    uint64_t arrives_us;
    uint8_t value;
  };
  /// Takes the next byte, when it has arrived by now.
  std::optional<Byte> receive_byte(uint64_t now_us);

 private:
  RadioOptions options_;
  WorldRandom random_;
  std::deque<Byte> in_flight_;
  double line_free_us_ = 0.0;  ///< when the UART has sent everything so far
};

}  // namespace screed
