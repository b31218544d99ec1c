// Key and boot epoch as bytes of an EEPROM.
#include "firmware/security/key_store.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "firmware/math/crc16.h"
#include "firmware/robot/parameter_store.h"
#include "host_sim/radio/command_key.h"

namespace screed {
namespace {

TEST(Crc16, CatalogueValue) {
  const uint8_t digits[] = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  EXPECT_EQ(crc16_ccitt(digits, sizeof digits), 0x29B1);
}

TEST(KeyStore, AKeyComesBackAndADamagedOneIsNone) {
  CommandKey key = test_key();
  key.robot_id = 42;
  uint8_t record[kKeyRecordSize];
  encode_key(credentials_of(key), record);
  Credentials read{};
  decode_key(record, read);
  EXPECT_TRUE(read.key_set);
  EXPECT_TRUE(std::equal(key.bytes.begin(), key.bytes.end(), read.key));
  EXPECT_EQ(read.robot_id, 42);
  for (int bit = 0; bit < 8 * kKeyRecordSize; ++bit) {
    record[bit / 8] = static_cast<uint8_t>(record[bit / 8] ^ (1U << (bit % 8)));
    decode_key(record, read);
    EXPECT_FALSE(read.key_set) << bit;
    record[bit / 8] = static_cast<uint8_t>(record[bit / 8] ^ (1U << (bit % 8)));
  }
}

TEST(KeyStore, AnErasedEepromHoldsNoKeyAndNoEpoch) {
  for (const int byte : {0x00, 0xFF}) {
    uint8_t record[kKeyRecordSize];
    std::fill(std::begin(record), std::end(record), static_cast<uint8_t>(byte));
    Credentials read{};
    decode_key(record, read);
    EXPECT_FALSE(read.key_set);
    uint8_t slot[kEpochSlotSize];
    std::fill(std::begin(slot), std::end(slot), static_cast<uint8_t>(byte));
    EXPECT_EQ(decode_epoch(slot), 0);
  }
}

TEST(KeyStore, EpochsUseTwoSlotsByTurnsBesideTheParameters) {
  for (const int start : {3, 4, 255, 256, 257, 65534, 65535}) {
    const auto epoch = static_cast<uint16_t>(start);
    uint8_t slot[kEpochSlotSize];
    encode_epoch(epoch, slot);
    EXPECT_EQ(decode_epoch(slot), epoch);
    EXPECT_NE(kEpochSlotAt(epoch), kEpochSlotAt(static_cast<uint16_t>(epoch + 1U)));
    // Power fails after 1, 2 or 3 of its bytes are written over those of two starts before.
    for (int written = 0; written < kEpochSlotSize; ++written) {
      uint8_t torn[kEpochSlotSize];
      encode_epoch(static_cast<uint16_t>(epoch - 2U), torn);
      std::copy_n(slot, written, torn);
      const uint16_t found = decode_epoch(torn);  // nothing, the old one, or already the new one
      EXPECT_TRUE(found == 0 || found == epoch - 2 || found == epoch) << epoch << " " << written;
    }
  }
  EXPECT_GE(kKeyRecordAt, kParameterCopyAt(kParameterCopies));
  EXPECT_GE(kEpochSlotAt(0), kKeyRecordAt + kKeyRecordSize);
}

}  // namespace
}  // namespace screed
