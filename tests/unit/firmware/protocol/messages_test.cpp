// Packing of message fields.
#include "firmware/protocol/messages.h"

#include <gtest/gtest.h>

#include <initializer_list>

namespace screed {
namespace {

TEST(Messages, NumbersAreLittleEndian) {
  uint8_t bytes[4];
  put_u16(bytes, 0x1234);
  EXPECT_EQ(bytes[0], 0x34);
  EXPECT_EQ(bytes[1], 0x12);
  put_u32(bytes, 0x89ABCDEF);
  EXPECT_EQ(bytes[0], 0xEF);
  EXPECT_EQ(bytes[1], 0xCD);
  EXPECT_EQ(bytes[2], 0xAB);
  EXPECT_EQ(bytes[3], 0x89);
  put_s16(bytes, -2);
  EXPECT_EQ(bytes[0], 0xFE);
  EXPECT_EQ(bytes[1], 0xFF);
}

TEST(Messages, SixteenBitsRoundTrip) {
  uint8_t bytes[2];
  for (int32_t value = INT16_MIN; value <= INT16_MAX; ++value) {
    put_s16(bytes, static_cast<int16_t>(value));
    ASSERT_EQ(get_s16(bytes), value);
    ASSERT_EQ(get_u16(bytes), static_cast<uint16_t>(value));
  }
}

TEST(Messages, DriveArgumentKeepsBothTwelveBitNumbers) {
  for (int32_t speed = -2048; speed <= 2047; speed += 13) {
    for (int32_t turn = -2048; turn <= 2047; turn += 17) {
      uint8_t bytes[3];
      put_drive_argument(bytes, {static_cast<int16_t>(speed), static_cast<int16_t>(turn)});
      const DriveArgument got = get_drive_argument(bytes);
      ASSERT_EQ(got.speed_mm_per_s, speed);
      ASSERT_EQ(got.turn_ddeg_per_s, turn);
    }
  }
}

TEST(Messages, DriveArgumentLayout) {
  // Speed in bits 0..11, turn in bits 12..23, little endian.
  uint8_t bytes[3];
  put_drive_argument(bytes, {0x123, -2});
  EXPECT_EQ(bytes[0], 0x23);
  EXPECT_EQ(bytes[1], 0xE1);
  EXPECT_EQ(bytes[2], 0xFF);
}

}  // namespace
}  // namespace screed
