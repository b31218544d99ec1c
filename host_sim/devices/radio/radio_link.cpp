// One direction of the XBee link.
#include "host_sim/devices/radio/radio_link.h"

#include <algorithm>
#include <cmath>

#include "host_sim/core/elementary.h"

namespace screed {
namespace {

/// Of the air: preamble, start, length, addresses, checksum (IEEE 802.15.4-2006, 6.3 and 7.2).
constexpr size_t kFrameOverhead = 6 + 11;
constexpr double kPathLossExponent = 3.0;
/// Signal to noise at the range: half of the packets of 100 bytes are lost (packet_loss() below).
constexpr double kSnrAtRange = 0.84092874812320639;

/// IEEE 802.15.4-2006, equation E.1: bit error rate at a signal to noise ratio.
double bit_error_rate(double snr) {
  double sum = 0.0;
  double binomial = 16.0;  // C(16, k), here of k = 1
  for (int k = 2; k <= 16; ++k) {
    binomial = binomial * (17 - k) / k;
    sum += (k % 2 == 0 ? 1.0 : -1.0) * binomial * portable::exp(20.0 * snr * (1.0 / k - 1.0));
  }
  return std::clamp(sum * 8.0 / 15.0 / 16.0, 0.0, 0.5);
}

double packet_loss(double snr, size_t bytes) {
  const auto bits = static_cast<double>(8 * (bytes + kFrameOverhead));
  return 1.0 - portable::pow(1.0 - bit_error_rate(snr), bits);
}

}  // namespace

double packet_loss_at(double distance_m, double range_m, size_t bytes) {
  if (distance_m <= 0.0) return 0.0;
  return packet_loss(kSnrAtRange * portable::pow(range_m / distance_m, kPathLossExponent), bytes);
}

void RadioLink::end_packet_after_pause(double now_us) {
  const double pause_end_us = sender_free_us_ + options_.pause_characters * character_us();
  if (!packet_.empty() && now_us >= pause_end_us) end_packet(pause_end_us);
}

void RadioLink::send(uint64_t now_us, std::span<const uint8_t> bytes) {
  if (bytes.empty()) return;
  const auto now = static_cast<double>(now_us);
  end_packet_after_pause(now);
  // From here on the line is busy: no pause ends a packet between these bytes.
  sender_free_us_ = std::max(sender_free_us_, now);
  const double step_us = character_us();
  while (!bytes.empty()) {
    const size_t room =
        options_.packet_bytes > packet_.size() ? options_.packet_bytes - packet_.size() : 1;
    const std::span<const uint8_t> fits = bytes.first(std::min(room, bytes.size()));
    // Added up, not multiplied: the same times however the bytes are handed over.
    for (size_t i = 0; i < fits.size(); ++i) sender_free_us_ += step_us;
    packet_.insert(packet_.end(), fits.begin(), fits.end());
    bytes = bytes.subspan(fits.size());
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
  // What was taken goes when it is half of what is there, so that no byte is moved often.
  if (2 * next_ >= bytes_.size()) {
    const auto taken = static_cast<std::ptrdiff_t>(next_);
    bytes_.erase(bytes_.begin(), bytes_.begin() + taken);
    arrivals_us_.erase(arrivals_us_.begin(), arrivals_us_.begin() + taken);
    next_ = 0;
  }
  const size_t begin = bytes_.size();
  bytes_.insert(bytes_.end(), packet_.begin(), packet_.end());
  if (options_.bit_errors > 0.0) flip_bits(std::span(bytes_).subspan(begin));
  receiver_free_us_ = std::max(receiver_free_us_, arrival_us);
  arrivals_us_.resize(bytes_.size());
  const double step_us = character_us();
  for (size_t i = begin; i < bytes_.size(); ++i) {
    receiver_free_us_ += step_us;
    arrivals_us_[i] = static_cast<uint64_t>(receiver_free_us_);
  }
}

void RadioLink::flip_bits(std::span<uint8_t> bytes) {
  for (uint8_t& byte : bytes) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      if (random_.uniform() >= options_.bit_errors) continue;
      byte = static_cast<uint8_t>(byte ^ (1U << bit));
      ++counts_.wrong_bits;
    }
  }
}

std::span<const uint8_t> RadioLink::receive(uint64_t now_us, size_t max_bytes) {
  end_packet_after_pause(static_cast<double>(now_us));
  const size_t begin = next_;
  const size_t end = begin + std::min(max_bytes, bytes_.size() - begin);
  while (next_ < end && arrivals_us_[next_] <= now_us) ++next_;
  return std::span(bytes_).subspan(begin, next_ - begin);
}

std::optional<RadioLink::Byte> RadioLink::receive_byte(uint64_t now_us) {
  const std::span<const uint8_t> one = receive(now_us, 1);
  if (one.empty()) return std::nullopt;
  return Byte{arrivals_us_[next_ - 1], one.front()};
}

}  // namespace screed
