// End-to-end protection against AUTOSAR's published vectors, and what it must find.
#include "firmware/protocol/e2e.h"

#include <gtest/gtest.h>

#include <cstring>
#include <set>
#include <vector>

#include "firmware/protocol/messages.h"
#include "host_sim/ground_station/telemetry/schema.h"

namespace screed {
namespace {

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

}  // namespace
}  // namespace screed
