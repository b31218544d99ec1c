// One direction of the XBee link: two modules in transparent mode, their serial lines, and the air
// between.
//
//   bytes -> serial line of the sender (rate) -> packets (pause or full) -> air (delay, loss,
//   distance, duplicates) -> serial line of the receiver (rate, wrong bits) -> bytes
//
// A packet arrives whole or not at all: on the air a checksum protects it. Wrong bits are those of
// the serial lines. Same seed and calls, same bytes.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "host_sim/core/random.h"

namespace screed {

struct RadioOptions {
  /// from a packet's end in the sending module to its first byte's way out
  double delay_s = 0.012;
  double loss = 0.0;  ///< probability that a packet is lost, 0..1
  /// of the serial lines: 10 bits a byte; 57,600 baud of an XBee is 58,824 (16 MHz / 272, as the
  /// microcontroller's)
  double bytes_per_s = 5882.35;
  double bit_errors = 0.0;   ///< probability that a bit of a delivered byte is wrong, 0..1
  double duplication = 0.0;  ///< probability that a delivered packet comes twice, 0..1
  /// Distance at which half of the full packets are lost, m; nothing: no distance is too far.
  std::optional<double> range_m = {};
  double pause_characters = 3.0;  ///< silence that ends a packet (parameter RO)
  size_t packet_bytes = 100;      ///< most bytes of a packet (parameter NP)
};

/// Probability that a packet of `bytes` is lost at a distance, when half of the full ones are lost
/// at range_m: bit error rate of the 2450 MHz O-QPSK of IEEE 802.15.4-2006 (annex E.4.1.8), signal
/// falling with the third power of the distance (antennas near the ground).
double packet_loss_at(double distance_m, double range_m, size_t bytes);

class RadioLink {
 public:
  RadioLink(uint64_t seed, std::string_view name, const RadioOptions& options)
      : options_(options), random_(seed, name) {}

  /// Hands bytes to the sending module, one after another from now on. Times rise.
  void send(uint64_t now_us, std::span<const uint8_t> bytes);

  /// Takes what has arrived by now, at most `max_bytes` bytes, in order. Holds until the next call.
  std::span<const uint8_t> receive(uint64_t now_us, size_t max_bytes);

  struct Byte {
    uint64_t arrives_us;
    uint8_t value;
  };
  /// Takes the next byte, when it has arrived by now.
  std::optional<Byte> receive_byte(uint64_t now_us);

  /// Between the modules, m; holds for packets that end from now on.
  void set_distance(double distance_m) { distance_m_ = distance_m; }

  struct Counts {
    uint64_t packets = 0;  ///< sent
    uint64_t lost = 0;     ///< of them
    uint64_t doubled = 0;
    uint64_t wrong_bits = 0;
  };
  const Counts& counts() const { return counts_; }

 private:
  double character_us() const { return 1e6 / options_.bytes_per_s; }
  void end_packet(double end_us);
  void end_packet_after_pause(double now_us);
  void deliver(double arrival_us);
  void flip_bits(std::span<uint8_t> bytes);

  RadioOptions options_;
  WorldRandom random_;
  double distance_m_ = 0.0;
  std::vector<uint8_t> packet_;    ///< being collected in the sending module
  double sender_free_us_ = 0.0;    ///< when the sender's line has carried everything so far
  double receiver_free_us_ = 0.0;  ///< likewise the receiver's
  // What is on its way: bytes from next_ on, and when each arrives. Every tick of every robot goes
  // through here, so bytes lie in one piece and are handed out where they lie.
  std::vector<uint8_t> bytes_;
  std::vector<uint64_t> arrivals_us_;
  size_t next_ = 0;
  Counts counts_;
};

}  // namespace screed
