// Damaged lines: no wrong frame where the protection promises none, few elsewhere.
#include <gtest/gtest.h>

#include "tools/bench/telemetry/corruption.h"

namespace screed {
namespace {

TEST(Corruption, RandomFramesAreAccepted) {
  RandomFrames frames(3);
  for (int i = 0; i < 2000; ++i) {
    const bool uplink = i % 2 != 0;
    const CanFrame frame = frames.next(uplink);
    ASSERT_TRUE(RandomFrames::accepts(frame, uplink));
    ASSERT_FALSE(RandomFrames::accepts(frame, !uplink));
  }
}

TEST(Corruption, NoWrongFrameOfOneWrongBitOrByte) {
  const std::vector<CorruptionResult> results = damage_lines(20000, 7);
  int strict = 0;
  for (const CorruptionResult& it : results) {
    EXPECT_EQ(it.lines, 20000U);
    if (it.damage.starts_with("one ") && it.damage.find(" and ") == std::string::npos) {
      ++strict;
      EXPECT_EQ(it.wrong_frames, 0U) << it.damage;
    } else {
      // An 8-bit CRC lets one of 256 pass at most; most damage does not come so far.
      EXPECT_LE(static_cast<double>(it.wrong_frames), 20000.0 / 200.0) << it.damage;
    }
    if (it.damage == "two random digits") {
      EXPECT_GT(it.wrong_lines, 10000U) << "the CRC has something to do";
    }
  }
  EXPECT_EQ(strict, 4);
}

}  // namespace
}  // namespace screed
