// SLCAN lines: round trip, and everything that is not exactly a data frame.
#include "firmware/protocol/slcan.h"

#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

namespace screed {
namespace {

std::string line_of(const CanFrame& frame) {
  uint8_t line[kSlcanLineMax];
  const uint8_t length = slcan_encode(frame, line);
  return {line, line + length};
}

struct Fed {
  std::vector<CanFrame> frames;
  int rejected;
};

Fed feed(const std::string& text) {
  SlcanParser parser;
  Fed fed;
  CanFrame frame{};
  for (const char c : text) {
    if (parser.feed(static_cast<uint8_t>(c), frame)) fed.frames.push_back(frame);
  }
  fed.rejected = parser.rejected();
  return fed;
}

TEST(Slcan, WritesLawicelLines) {
  EXPECT_EQ(line_of({0x7FF, 0, {}}), "t7FF0\r");
  EXPECT_EQ(line_of({0x001, 3, {0x00, 0xAB, 0x9F}}), "t001300AB9F\r");
  EXPECT_EQ(line_of({0x210, 8, {1, 2, 3, 4, 5, 6, 7, 0xFE}}),
            "t2108010203040506"
            "07FE\r");
}

TEST(Slcan, RoundTripOfEveryIdSizeAndByte) {
  for (uint16_t id = 0; id < 0x800; ++id) {
    CanFrame frame{id, static_cast<uint8_t>(id % 9), {}};
    for (uint8_t i = 0; i < frame.size; ++i) frame.data[i] = static_cast<uint8_t>(id * 7 + i * 31);
    const Fed fed = feed(line_of(frame));
    ASSERT_EQ(fed.frames.size(), 1U);
    EXPECT_EQ(fed.frames[0].id, id);
    EXPECT_EQ(fed.frames[0].size, frame.size);
    EXPECT_EQ(std::memcmp(fed.frames[0].data, frame.data, frame.size), 0);
  }
}

TEST(Slcan, LowerCaseIsRead) {
  const Fed fed = feed("t7ff2abCd\r");
  ASSERT_EQ(fed.frames.size(), 1U);
  EXPECT_EQ(fed.frames[0].id, 0x7FF);
  EXPECT_EQ(fed.frames[0].data[0], 0xAB);
  EXPECT_EQ(fed.frames[0].data[1], 0xCD);
}

TEST(Slcan, TheLengthMustFit) {
  const std::string whole =
      "t2108"
      "0102030405060708";
  for (size_t length = 1; length < whole.size(); ++length) {
    const Fed fed = feed(whole.substr(0, length) + "\r");
    EXPECT_TRUE(fed.frames.empty()) << length;
    EXPECT_EQ(fed.rejected, 1) << length;
  }
  for (const char* line :
       {"t2100AA\r", "t2101\r", "t21010\r", "t2101000\r", "t2109010203040506070809\r", "t210A\r"}) {
    const Fed fed = feed(line);
    EXPECT_TRUE(fed.frames.empty()) << line;
    EXPECT_EQ(fed.rejected, 1) << line;
  }
}

TEST(Slcan, ForeignCharactersAndIdsBeyondElevenBitsAreRejected) {
  for (const char* line : {"t8001AA\r", "tFFF0\r", "t21G0\r", "t2 00\r", "t2101A/\r", "t2101:A\r",
                           "t2101@A\r", "t2101`A\r", "t2101gA\r"}) {
    const Fed fed = feed(line);
    EXPECT_TRUE(fed.frames.empty()) << line;
    EXPECT_EQ(fed.rejected, 1) << line;
  }
}

TEST(Slcan, WhatSlcandSendsIsIgnoredAndDoesNotCount) {
  const Fed fed = feed("C\rS6\rO\r\r\rV\rT000002101AA\rr2100\rt2101AA\r");
  ASSERT_EQ(fed.frames.size(), 1U);
  EXPECT_EQ(fed.rejected, 0);
}

TEST(Slcan, LinesTooLongAreDroppedWholeAndTheNextIsRead) {
  // The first 21 characters of the long line alone would be a frame.
  const std::string frame =
      "t2108"
      "0102030405060708";
  const Fed fed = feed(frame + "A\r" + frame + std::string(1000, '0') + "\r" + "t2101AA\r");
  ASSERT_EQ(fed.frames.size(), 1U);
  EXPECT_EQ(fed.frames[0].size, 1);
  EXPECT_EQ(fed.rejected, 2);
}

TEST(Slcan, ALostEndMergesTwoLinesIntoNone) {
  const Fed fed = feed("t2101AAt2101BB\rt2101CC\r");
  ASSERT_EQ(fed.frames.size(), 1U);
  EXPECT_EQ(fed.frames[0].data[0], 0xCC);
  EXPECT_EQ(fed.rejected, 1);
}

TEST(Slcan, WithoutAnEndThereIsNoFrame) {
  EXPECT_TRUE(feed("t2101AA").frames.empty());
  EXPECT_TRUE(feed("t2101AA\n").frames.empty());
}

TEST(Slcan, AnyByteAnywhereIsSafe) {
  const std::string line = "t2102AABB\r";
  for (size_t at = 0; at < line.size(); ++at) {
    for (int value = 0; value < 256; ++value) {
      std::string wrong = line;
      wrong[at] = static_cast<char>(value);
      const Fed fed = feed(wrong + line);
      EXPECT_LE(fed.frames.size(), 2U);
      for (const CanFrame& frame : fed.frames) EXPECT_LE(frame.size, 8);
    }
  }
}

}  // namespace
}  // namespace screed
