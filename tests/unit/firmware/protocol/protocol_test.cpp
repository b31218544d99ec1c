// The protocol: protection end to end, packing, lines of text.
#include <gtest/gtest.h>
#include <cstring>
#include <initializer_list>
#include <set>
#include <string>
#include <vector>

#include "firmware/protocol/e2e.h"
#include "firmware/protocol/messages.h"
#include "firmware/protocol/slcan.h"
#include "host_sim/ground_station/telemetry/schema.h"

namespace screed {

namespace {

// End-to-end protection against AUTOSAR's published vectors, and what it must find.

constexpr uint16_t kAllIds[] = {kIdGroundHeartbeat, kIdEmergencyStop, kIdHeartbeat, kIdCommand,
                                kIdCommandAck,      kIdAttitude,      kIdLeveling,  kIdEncoders,
                                kIdMotors,          kIdOdometry,      kIdAccelRaw,  kIdGyroRaw,
                                kIdMagRaw,          kIdBaro,          kIdPower};

TEST(E2e, CrcHasTheCheckValueOfAutosar) {
  // AUTOSAR, Specification of CRC Routines: the table of CRC8H2F, and the check value over
  // "123456789".
  struct Vector {
    std::vector<uint8_t> data;
    int crc;
  };
  const Vector vectors[] = {
      {{'1', '2', '3', '4', '5', '6', '7', '8', '9'}, 0xDF},
      {{0x00, 0x00, 0x00, 0x00}, 0x12},
      {{0xF2, 0x01, 0x83}, 0xC2},
      {{0x0F, 0xAA, 0x00, 0x55}, 0xC6},
      {{0x00, 0xFF, 0x55, 0x11}, 0x77},
      {{0x33, 0x22, 0x55, 0xAA, 0xBB, 0xCC, 0xDD, 0xEE, 0xFF}, 0x11},
      {{0x92, 0x6B, 0x55}, 0x33},
      {{0xFF, 0xFF, 0xFF, 0xFF}, 0x6C},
  };
  for (const Vector& vector : vectors) {
    EXPECT_EQ(crc8_h2f(0xFF, vector.data.data(), static_cast<uint8_t>(vector.data.size())) ^ 0xFF,
              vector.crc);
  }
}

TEST(E2e, ProfileTwoVectorOfZeros) {
  // AUTOSAR counts up before it sends: the first frame after start carries counter 1. Data id list
  // of zeros.
  const uint8_t data[8] = {0, 1, 0, 0, 0, 0, 0, 0};
  EXPECT_EQ(e2e_crc(0, data, 8), 0x45);
}

TEST(E2e, ProfileTwoVectorOfSixteenIds) {
  // Bytes 0..7, data id list 0..15: counter 2 takes id 2 of the list.
  const uint8_t data[8] = {0, 2, 2, 3, 4, 5, 6, 7};
  EXPECT_EQ(e2e_crc(2, data, 8), 0xBC);
}

TEST(E2e, WhatIsProtectedChecksAndTheMessageBitsStay) {
  for (const uint16_t id : kAllIds) {
    for (uint8_t size = 3; size <= 8; ++size) {
      for (uint8_t counter = 0; counter < 16; ++counter) {
        uint8_t data[8] = {0xEE, 0xA5, 1, 2, 3, 4, 5, 6};
        e2e_protect(id, counter, data, size);
        EXPECT_TRUE(e2e_check(id, data, size));
        EXPECT_EQ(data[1], 0xA0 | counter);
        EXPECT_EQ(data[2], 1);
      }
    }
  }
}

TEST(E2e, EverySingleWrongBitIsFound) {
  for (const uint16_t id : kAllIds) {
    for (uint8_t size = 3; size <= 8; ++size) {
      for (uint8_t counter = 0; counter < 16; ++counter) {
        uint8_t data[8] = {0, 0x30, 0x12, 0x34, 0x56, 0x78, 0x9A, 0xBC};
        e2e_protect(id, counter, data, size);
        for (int bit = 0; bit < size * 8; ++bit) {
          uint8_t wrong[8];
          std::memcpy(wrong, data, 8);
          wrong[bit / 8] = static_cast<uint8_t>(wrong[bit / 8] ^ (1U << (bit % 8)));
          ASSERT_FALSE(e2e_check(id, wrong, size))
              << id << " " << static_cast<int>(size) << " bit " << bit;
        }
      }
    }
  }
}

// One wrong byte of a line is one wrong digit, of the id or of the data.
TEST(E2e, EverySingleWrongDigitIsFoundInMessagesOfEveryRobot) {
  for (const MessageInfo& message : messages()) {
    for (uint8_t node = 1; node < 16; ++node) {
      const uint16_t id = id_of_node(message.id, node);
      for (uint8_t counter = 0; counter < 16; ++counter) {
        uint8_t data[8] = {0, 0x30, 0x12, 0x34, 0x56, 0x78, 0x9A, 0xBC};
        e2e_protect(id, counter, data, message.size);
        for (int digit = 0; digit < message.size * 2; ++digit) {
          for (unsigned change = 1; change < 16; ++change) {
            uint8_t wrong[8];
            std::memcpy(wrong, data, 8);
            wrong[digit / 2] = static_cast<uint8_t>(wrong[digit / 2] ^ (change << (digit % 2 * 4)));
            ASSERT_FALSE(e2e_check(id, wrong, message.size))
                << message.name << " digit " << digit << " xor " << change;
          }
        }
        for (unsigned shift = 0; shift < 12; shift += 4) {
          for (unsigned change = 1; change < (shift == 8 ? 8U : 16U); ++change) {
            ASSERT_FALSE(
                e2e_check(static_cast<uint16_t>(id ^ (change << shift)), data, message.size));
          }
        }
      }
    }
  }
}

TEST(E2e, UpToThreeWrongBitsOfIdDataAndCrcAreFound) {
  // The check is linear: what one wrong bit does to it does not depend on the frame.
  for (uint8_t size = 3; size <= 8; ++size) {
    uint8_t data[8] = {};
    e2e_protect(0, 0, data, size);
    const auto wrong_crc = [&](uint16_t id, int bit) {
      uint8_t wrong[8];
      std::memcpy(wrong, data, 8);
      if (bit >= 0) wrong[bit / 8] = static_cast<uint8_t>(wrong[bit / 8] ^ (1U << (bit % 8)));
      return wrong[0] ^ e2e_crc(e2e_data_id(id), wrong, size);
    };
    std::vector<int> effects;
    for (unsigned bit = 0; bit < 11; ++bit) {
      effects.push_back(wrong_crc(static_cast<uint16_t>(1U << bit), -1));
    }
    for (int bit = 0; bit < size * 8; ++bit) effects.push_back(wrong_crc(0, bit));
    for (size_t i = 0; i < effects.size(); ++i) {
      ASSERT_NE(effects[i], 0);
      for (size_t j = 0; j < i; ++j) {
        ASSERT_NE(effects[i] ^ effects[j], 0) << i << " " << j;
        for (size_t k = 0; k < j; ++k) {
          ASSERT_NE(effects[i] ^ effects[j] ^ effects[k], 0) << i << " " << j << " " << k;
        }
      }
    }
  }
}

TEST(E2e, AFrameUnderAnotherIdIsFound) {
  uint8_t data[8] = {0, 0, 1, 2, 3, 4, 5, 6};
  for (const uint16_t id : kAllIds) {
    for (uint8_t counter = 0; counter < 16; ++counter) {
      e2e_protect(id, counter, data, 8);
      for (const uint16_t other : kAllIds) ASSERT_EQ(e2e_check(other, data, 8), other == id);
      // A wrong bit in the id's text digits.
      for (int bit = 0; bit < 11; ++bit)
        ASSERT_FALSE(e2e_check(static_cast<uint16_t>(id ^ (1U << bit)), data, 8));
    }
  }
}

TEST(E2e, AFrameOfAnotherSizeIsFound) {
  uint8_t data[8] = {0, 0, 1, 2, 3, 4, 5, 6};
  e2e_protect(kIdAttitude, 3, data, 8);
  for (uint8_t size = 0; size < 8; ++size) EXPECT_FALSE(e2e_check(kIdAttitude, data, size));
  EXPECT_FALSE(e2e_check(kIdAttitude, data, 9));
  EXPECT_FALSE(e2e_check(kIdAttitude, data, 255));
}

TEST(E2e, AFrameLongerThanCanHoldsIsRefusedThoughItsCrcIsRight) {
  uint8_t data[9] = {0, 0, 1, 2, 3, 4, 5, 6, 7};
  e2e_protect(kIdAttitude, 3, data, 9);
  EXPECT_FALSE(e2e_check(kIdAttitude, data, 9));
}

TEST(E2e, TheHeaderAloneIsRefused) {
  uint8_t data[2] = {0, 0};
  e2e_protect(kIdEmergencyStop, 0, data, 2);
  EXPECT_FALSE(e2e_check(kIdEmergencyStop, data, 2));
}

TEST(E2e, DataIdsOfTheMessagesDiffer) {
  std::set<uint8_t> ids;
  for (const MessageInfo& message : messages()) ids.insert(e2e_data_id(message.id));
  EXPECT_EQ(ids.size(), messages().size());
}

// Packing of message fields.

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

// SLCAN lines: round trip, and everything that is not exactly a data frame.

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
