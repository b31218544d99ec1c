// The radio model against closed formulas: rates, packets, losses, wrong bits, distance.
#include "host_sim/devices/radio/radio_link.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>

namespace screed {
namespace {

std::vector<uint8_t> bytes(size_t count, uint8_t first = 0) {
  std::vector<uint8_t> all(count);
  std::iota(all.begin(), all.end(), first);
  return all;
}

/// Lines so fast that they take no time.
RadioOptions instant() {
  RadioOptions options;
  options.delay_s = 0.0;
  options.bytes_per_s = 1e9;
  return options;
}

/// Five standard deviations of a count with this probability.
double five_sigma(double probability, double trials) {
  return 5.0 * std::sqrt(probability * (1.0 - probability) * trials);
}

TEST(RadioLink, APacketTakesBothLinesThePauseAndTheDelay) {
  RadioOptions options;
  options.bytes_per_s = 5760.0;
  RadioLink link(1, "test", options);
  link.send(1000, bytes(2));
  // A character of 10 bits at 57,600 baud takes 173.6 us: two in, three of silence, one out.
  const double first_us = 1000.0 + 6.0 * 1e6 / 5760.0 + 12000.0;
  const auto first = static_cast<uint64_t>(first_us);
  EXPECT_TRUE(link.receive(first - 1, 100).empty());
  EXPECT_EQ(link.receive(first, 100).size(), 1U);
  EXPECT_TRUE(link.receive(first + 172, 100).empty());
  EXPECT_EQ(link.receive(first + 174, 100).size(), 1U);
  EXPECT_TRUE(link.receive(10000000, 100).empty());
}

TEST(RadioLink, OrderAndContentAreKept) {
  RadioLink link(1, "test", RadioOptions{});
  link.send(0, bytes(100));
  link.send(10, bytes(50, 100));
  std::vector<uint8_t> all;
  for (uint64_t now = 0; now < 100000; now += 700) {
    for (const uint8_t byte : link.receive(now, 3)) all.push_back(byte);
  }
  EXPECT_EQ(all, bytes(150));
}

TEST(RadioLink, BytesComeOneByOneAsTheyComeTogether) {
  // Looked for seldom, so that packets end, and their bytes arrive, in the very call that takes
  // them: after none, some and most of the packet before.
  RadioOptions options = instant();
  options.bytes_per_s = 1000.0;
  for (const uint64_t step_us : {1000U, 5000U, 7000U}) {
    RadioLink together(1, "test", options);
    RadioLink single(1, "test", options);
    std::vector<uint8_t> all;
    uint8_t next = 0;
    for (uint64_t now = 0; now < 2000000; now += step_us) {
      if (now / step_us % 3 == 0) {
        const std::vector<uint8_t> packet = bytes(1 + now / step_us * 5 % 7, next);
        next = static_cast<uint8_t>(next + packet.size());
        together.send(now, packet);
        for (const uint8_t byte : packet) single.send(now, {&byte, 1});
      }
      for (const uint8_t byte : together.receive(now, SIZE_MAX)) {
        const std::optional<RadioLink::Byte> one = single.receive_byte(now);
        ASSERT_TRUE(one.has_value()) << now;
        ASSERT_EQ(one->value, byte) << now;
        ASSERT_LE(one->arrives_us, now);
        ASSERT_GT(one->arrives_us + step_us, now);
        all.push_back(byte);
      }
      ASSERT_FALSE(single.receive_byte(now).has_value()) << now;
    }
    ASSERT_GT(all.size(), 100U);
    EXPECT_EQ(all, bytes(all.size()));
  }
}

TEST(RadioLink, TheThroughputIsThatOfTheSerialLine) {
  // More than the line can carry: a second's worth arrives in a second, but for the packet that is
  // still on its way; the rest waits.
  RadioOptions options;
  options.delay_s = 0.0;
  options.bytes_per_s = 5760.0;
  RadioLink link(1, "test", options);
  for (uint64_t now = 0; now < 1000000; now += 10000) link.send(now, bytes(100));
  const size_t arrived = link.receive(1000000, SIZE_MAX).size();
  EXPECT_LE(arrived, 5760U);
  EXPECT_GE(arrived, 5760U - options.packet_bytes);
  EXPECT_EQ(link.receive(2000000, SIZE_MAX).size(), 10000U - arrived);
}

TEST(RadioLink, ReceivesAtMostWhatIsAskedFor) {
  RadioLink link(1, "test", RadioOptions{});
  link.send(0, bytes(100));
  EXPECT_EQ(link.receive(1000000, 64).size(), 64U);
  EXPECT_EQ(link.receive(1000000, 64).front(), 64);
}

TEST(RadioLink, APacketEndsWithAPauseOfThreeCharacters) {
  RadioOptions options;
  options.bytes_per_s = 1000.0;  // 1 ms a character
  RadioLink close(1, "test", options);
  close.send(0, bytes(5));
  close.send(7000, bytes(5));  // 2 ms of silence
  close.receive(1000000, SIZE_MAX);
  EXPECT_EQ(close.counts().packets, 1U);
  RadioLink apart(1, "test", options);
  apart.send(0, bytes(5));
  apart.send(8000, bytes(5));  // 3 ms
  apart.receive(1000000, SIZE_MAX);
  EXPECT_EQ(apart.counts().packets, 2U);
}

TEST(RadioLink, APacketEndsWhenItIsFull) {
  RadioLink link(1, "test", instant());
  link.send(0, bytes(250));
  EXPECT_EQ(link.counts().packets, 2U);
  link.receive(1000000, SIZE_MAX);
  EXPECT_EQ(link.counts().packets, 3U);
}

TEST(RadioLink, WholePacketsAreLostAtTheirRate) {
  constexpr int kPackets = 20000;
  RadioOptions options = instant();
  options.loss = 0.2;
  RadioLink link(1, "test", options);
  int lost = 0;
  for (int i = 0; i < kPackets; ++i) {
    const auto now = static_cast<uint64_t>(i) * 10000;
    link.send(now, bytes(10));
    const size_t arrived = link.receive(now + 9999, SIZE_MAX).size();
    ASSERT_TRUE(arrived == 0 || arrived == 10);
    if (arrived == 0) ++lost;
  }
  EXPECT_NEAR(lost, 0.2 * kPackets, five_sigma(0.2, kPackets));
  EXPECT_EQ(link.counts().lost, static_cast<uint64_t>(lost));
}

TEST(RadioLink, LossOfNothingAndOfEverything) {
  RadioOptions all = instant();
  all.loss = 1.0;
  RadioLink safe(1, "test", instant());
  RadioLink dead(1, "test", all);
  for (uint64_t i = 0; i < 1000; ++i) {
    safe.send(i * 10000, bytes(1));
    dead.send(i * 10000, bytes(1));
  }
  EXPECT_EQ(safe.receive(100000000, SIZE_MAX).size(), 1000U);
  EXPECT_TRUE(dead.receive(100000000, SIZE_MAX).empty());
}

TEST(RadioLink, BitsAreWrongAtTheirRate) {
  constexpr double kRate = 0.003;
  constexpr int kBytes = 100000;
  RadioOptions options = instant();
  options.bit_errors = kRate;
  RadioLink link(3, "test", options);
  int wrong = 0;
  for (int i = 0; i < kBytes / 100; ++i) {
    link.send(static_cast<uint64_t>(i) * 1000, bytes(100));
    const std::span<const uint8_t> arrived =
        link.receive(static_cast<uint64_t>(i) * 1000 + 999, 1000);
    ASSERT_EQ(arrived.size(), 100U);
    for (size_t k = 0; k < 100; ++k) {
      wrong += __builtin_popcount(static_cast<unsigned>(arrived[k] ^ static_cast<uint8_t>(k)));
    }
  }
  EXPECT_NEAR(wrong, kRate * 8 * kBytes, five_sigma(kRate, 8.0 * kBytes));
  EXPECT_EQ(link.counts().wrong_bits, static_cast<uint64_t>(wrong));
}

TEST(RadioLink, PacketsAreDoubledAtTheirRate) {
  constexpr int kPackets = 20000;
  RadioOptions options = instant();
  options.duplication = 0.1;
  options.loss = 0.5;
  RadioLink link(3, "test", options);
  int doubled = 0;
  int arrived = 0;
  for (int i = 0; i < kPackets; ++i) {
    const auto now = static_cast<uint64_t>(i) * 10000;
    link.send(now, bytes(10));
    const std::span<const uint8_t> got = link.receive(now + 9999, SIZE_MAX);
    if (got.empty()) continue;
    ++arrived;
    if (got.size() != 20) continue;
    ++doubled;
    EXPECT_TRUE(std::equal(got.begin(), got.begin() + 10, got.begin() + 10));
  }
  // Of those that were not lost.
  EXPECT_NEAR(doubled, 0.1 * arrived, five_sigma(0.1, arrived));
}

TEST(RadioLink, DistanceLosesPacketsAsTheStandardSays) {
  // Half of the full packets at the range, and shorter ones are lost less often.
  EXPECT_NEAR(packet_loss_at(50.0, 50.0, 100), 0.5, 1e-13);
  const double shorter = packet_loss_at(50.0, 50.0, 22);
  // Independent bits: (1 - p)^(8 (n + 17)) of both lengths belong together.
  EXPECT_NEAR(std::pow(1.0 - shorter, 117.0 / 39.0), 0.5, 1e-9);
  // IEEE 802.15.4-2006, figure E.2: the bit error rate falls below 1e-9 within 5 dB above it.
  EXPECT_LT(packet_loss_at(30.0, 50.0, 100), 1e-6);
  EXPECT_GT(packet_loss_at(70.0, 50.0, 100), 0.999);
  EXPECT_EQ(packet_loss_at(0.0, 50.0, 100), 0.0);
  double before = 0.0;
  for (double distance = 1.0; distance < 200.0; distance += 1.0) {
    const double now = packet_loss_at(distance, 50.0, 100);
    EXPECT_GE(now, before);
    before = now;
  }
}

TEST(RadioLink, ARobotOutOfRangeIsNotHeard) {
  constexpr int kPackets = 5000;
  RadioOptions options = instant();
  options.range_m = 50.0;
  const auto lost_at = [&](double distance_m) {
    RadioLink link(5, "test", options);
    link.set_distance(distance_m);
    for (int i = 0; i < kPackets; ++i) link.send(static_cast<uint64_t>(i) * 10000, bytes(100));
    return static_cast<double>(link.counts().lost);
  };
  EXPECT_EQ(lost_at(20.0), 0.0);
  EXPECT_NEAR(lost_at(50.0), 0.5 * kPackets, five_sigma(0.5, kPackets));
  EXPECT_EQ(lost_at(100.0), kPackets);
}

TEST(RadioLink, ChanceIsRepeatable) {
  RadioOptions options = instant();
  options.loss = 0.3;
  options.bit_errors = 0.01;
  options.duplication = 0.2;
  for (const uint64_t seed : {1ULL, 2ULL}) {
    RadioLink one(seed, "uplink", options);
    RadioLink two(seed, "uplink", options);
    for (uint64_t i = 0; i < 200; ++i) {
      one.send(i * 1000, bytes(5));
      two.send(i * 1000, bytes(5));
      ASSERT_TRUE(
          std::ranges::equal(one.receive(i * 1000 + 999, 100), two.receive(i * 1000 + 999, 100)));
    }
  }
}

}  // namespace
}  // namespace screed
