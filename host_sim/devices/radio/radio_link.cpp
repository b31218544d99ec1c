// One direction of the XBee link.
#include "host_sim/devices/radio/radio_link.h"

#include <algorithm>
#include <cmath>

namespace screed {
namespace {

/// Of the air: preamble, start, length, addresses, checksum (IEEE 802.15.4-2006, 6.3 and 7.2).
constexpr size_t kFrameOverhead = 6 + 11;
constexpr size_t kFullPacket = 100;
constexpr double kPathLossExponent = 3.0;

/// IEEE 802.15.4-2006, equation E.1: bit error rate at a signal to noise ratio.
double bit_error_rate(double snr) {
  double sum = 0.0;
  double binomial = 16.0;  // C(16, k), here of k = 1
  for (int k = 2; k <= 16; ++k) {
    binomial = binomial * (17 - k) / k;
    sum += (k % 2 == 0 ? 1.0 : -1.0) * binomial * std::exp(20.0 * snr * (1.0 / k - 1.0));
  }
  return std::clamp(sum * 8.0 / 15.0 / 16.0, 0.0, 0.5);
}

double packet_loss(double snr, size_t bytes) {
  const auto bits = static_cast<double>(8 * (bytes + kFrameOverhead));
  return 1.0 - std::pow(1.0 - bit_error_rate(snr), bits);
}

/// The ratio at which half of the full packets are lost.
double snr_at_range() {
  double low = 0.0;
  double high = 10.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (packet_loss(middle, kFullPacket) > 0.5 ? low : high) = middle;
  }
  return low;
}

}  // namespace

double packet_loss_at(double distance_m, double range_m, size_t bytes) {
  static const double kSnrAtRange = snr_at_range();
  if (distance_m <= 0.0) return 0.0;
  return packet_loss(kSnrAtRange * std::pow(range_m / distance_m, kPathLossExponent), bytes);
}

void RadioLink::send(uint64_t now_us, std::span<const uint8_t> bytes) {
  const double pause_us = options_.pause_characters * character_us();
  const auto now = static_cast<double>(now_us);
  for (const uint8_t byte : bytes) {
    if (!packet_.empty() && now >= sender_free_us_ + pause_us)
      end_packet(sender_free_us_ + pause_us);
    sender_free_us_ = std::max(sender_free_us_, now) + character_us();
    packet_.push_back(byte);
    if (packet_.size() >= options_.packet_bytes) end_packet(sender_free_us_);
  }
}

/// The sending module has a packet and gives it to the air.
void RadioLink::end_packet(double end_us) {
  ++counts_.packets;
  // Drawn in any case: what happens to one packet changes nothing for the next.
  const bool lost = random_.uniform() < options_.loss;
  const bool too_far =
      options_.range_m.has_value() &&
      random_.uniform() < packet_loss_at(distance_m_, *options_.range_m, packet_.size());
  const bool doubled = options_.duplication > 0.0 && random_.uniform() < options_.duplication;
  if (lost || too_far) {
    ++counts_.lost;
  } else {
    const double arrival_us = end_us + options_.delay_s * 1e6;
    deliver(arrival_us);
    if (doubled) {
      ++counts_.doubled;
      deliver(arrival_us);
    }
  }
  packet_.clear();
}

void RadioLink::deliver(double arrival_us) {
  receiver_free_us_ = std::max(receiver_free_us_, arrival_us);
  for (uint8_t byte : packet_) {
    for (unsigned bit = 0; options_.bit_errors > 0.0 && bit < 8; ++bit) {
      if (random_.uniform() >= options_.bit_errors) continue;
      byte = static_cast<uint8_t>(byte ^ (1U << bit));
      ++counts_.wrong_bits;
    }
    receiver_free_us_ += character_us();
    in_flight_.push_back({static_cast<uint64_t>(receiver_free_us_), byte});
  }
}

std::vector<uint8_t> RadioLink::receive(uint64_t now_us, size_t max_bytes) {
  std::vector<uint8_t> bytes;
  while (bytes.size() < max_bytes) {
    const std::optional<Byte> byte = receive_byte(now_us);
    if (!byte.has_value()) break;
    bytes.push_back(byte->value);
  }
  return bytes;
}

std::optional<RadioLink::Byte> RadioLink::receive_byte(uint64_t now_us) {
  const double pause_end_us = sender_free_us_ + options_.pause_characters * character_us();
  if (!packet_.empty() && static_cast<double>(now_us) >= pause_end_us) end_packet(pause_end_us);
  if (in_flight_.empty() || in_flight_.front().arrives_us > now_us) return std::nullopt;
  const Byte byte = in_flight_.front();
  in_flight_.pop_front();
  return byte;
}

}  // namespace screed
