// The radio as a pipe of bytes.
#include "host_sim/radio/radio_link.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace screed {
namespace {

std::vector<uint8_t> bytes(size_t count, uint8_t first = 0) {
  std::vector<uint8_t> all(count);
  std::iota(all.begin(), all.end(), first);
  return all;
}

TEST(RadioLink, AByteTakesItsTimeOnTheLineAndTheDelay) {
  RadioLink link(1, "test", {0.012, 0.0, 5760.0});
  link.send(1000, bytes(1));
  // 10 bits at 57,600 baud are 173.6 us.
  EXPECT_TRUE(link.receive(1000 + 12000 + 173 - 1, 100).empty());
  EXPECT_EQ(link.receive(1000 + 12000 + 174, 100).size(), 1U);
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

TEST(RadioLink, TheRateIsThatOfTheUart) {
  // More than the line can carry: a second's worth arrives in a second, the rest waits.
  RadioLink link(1, "test", {0.0, 0.0, 5760.0});
  for (uint64_t now = 0; now < 1000000; now += 10000) link.send(now, bytes(100));
  EXPECT_NEAR(static_cast<double>(link.receive(1000000, SIZE_MAX).size()), 5760.0, 1.0);
  EXPECT_EQ(link.receive(2000000, SIZE_MAX).size(), 10000U - 5760U);
}

TEST(RadioLink, ReceivesAtMostWhatIsAskedFor) {
  RadioLink link(1, "test", RadioOptions{});
  link.send(0, bytes(100));
  EXPECT_EQ(link.receive(1000000, 64).size(), 64U);
  EXPECT_EQ(link.receive(1000000, 64).front(), 64);
}

TEST(RadioLink, WholePacketsAreLost) {
  constexpr int kPackets = 20000;
  RadioLink link(1, "test", {0.0, 0.2, 1e9});
  int lost = 0;
  for (int i = 0; i < kPackets; ++i) {
    const auto now = static_cast<uint64_t>(i) * 10000;
    link.send(now, bytes(10));
    const size_t arrived = link.receive(now + 9999, SIZE_MAX).size();
    ASSERT_TRUE(arrived == 0 || arrived == 10);
    if (arrived == 0) ++lost;
  }
  EXPECT_NEAR(lost, 0.2 * kPackets, 5.0 * std::sqrt(0.16 * kPackets));
}

TEST(RadioLink, LossOfNothingAndOfEverything) {
  RadioLink safe(1, "test", {0.0, 0.0, 1e9});
  RadioLink dead(1, "test", {0.0, 1.0, 1e9});
  for (uint64_t i = 0; i < 1000; ++i) {
    safe.send(i * 10000, bytes(1));
    dead.send(i * 10000, bytes(1));
  }
  EXPECT_EQ(safe.receive(100000000, SIZE_MAX).size(), 1000U);
  EXPECT_TRUE(dead.receive(100000000, SIZE_MAX).empty());
}

TEST(RadioLink, ALostPacketStillTakesItsTimeOnTheLine) {
  RadioLink link(4, "test", {0.0, 0.5, 1000.0});
  for (int i = 0; i < 100; ++i) link.send(0, bytes(10));
  // 1000 bytes at 1000 bytes/s: whatever was lost, the last one comes at the end of the second.
  const size_t before = link.receive(500000, SIZE_MAX).size();
  const size_t after = link.receive(1000000, SIZE_MAX).size();
  EXPECT_NEAR(static_cast<double>(before), 250.0, 180.0);
  EXPECT_NEAR(static_cast<double>(after), 250.0, 180.0);
  EXPECT_TRUE(link.receive(2000000, SIZE_MAX).empty());
}

TEST(RadioLink, LossIsRepeatable) {
  for (const uint64_t seed : {1ULL, 2ULL}) {
    RadioLink one(seed, "uplink", {0.0, 0.5, 1e9});
    RadioLink two(seed, "uplink", {0.0, 0.5, 1e9});
    for (uint64_t i = 0; i < 200; ++i) {
      one.send(i * 1000, bytes(1));
      two.send(i * 1000, bytes(1));
      ASSERT_EQ(one.receive(i * 1000 + 999, 10).size(), two.receive(i * 1000 + 999, 10).size());
    }
  }
}

}  // namespace
}  // namespace screed
