// Key and boot epoch as bytes of an EEPROM.
#include "firmware/security/key_store.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "firmware/math/crc16.h"
#include "firmware/parameters/parameter_store.h"
#include "host_sim/ground_station/station/command_key.h"

namespace screed {
namespace {

TEST(Crc16, CatalogueValue) {
  const uint8_t digits[] = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  EXPECT_EQ(crc16_ccitt(digits, sizeof digits), 0x29B1);
}

CommandKey some_key() {
  CommandKey key = test_key();
  key.robot_id = 42;
  return key;
}

TEST(KeyStore, AKeyComesBackAndADamagedOneIsNone) {
  const CredentialRecord record = credential_record(credentials_of(some_key(), 77));
  CredentialRecord started = record;
  Credentials read{};
  EXPECT_TRUE(begin_start(started, read));
  EXPECT_TRUE(read.key_set);
  EXPECT_EQ(command_key_of(read), some_key());
  EXPECT_EQ(read.boot_epoch, 77);
  for (int bit = 0; bit < 8 * (kKeySize + 2); ++bit) {
    CredentialRecord damaged = record;
    damaged.bytes[bit / 8] = static_cast<uint8_t>(damaged.bytes[bit / 8] ^ (1U << (bit % 8)));
    CredentialRecord twice = damaged;
    EXPECT_TRUE(begin_start(damaged, read));
    EXPECT_TRUE(read.key_set) << bit << ": the second copy";
    EXPECT_EQ(command_key_of(read), some_key());
    uint8_t& second = twice.bytes[kSecondKeyOffset + bit / 8];
    second = static_cast<uint8_t>(second ^ (1U << (bit % 8)));
    EXPECT_TRUE(begin_start(twice, read));
    EXPECT_FALSE(read.key_set) << bit;
    EXPECT_EQ(read.boot_epoch, 77) << bit;
  }
}

TEST(KeyStore, ATornWriteLeavesTheOldKeyOrTheNew) {
  const CredentialRecord old = credential_record(credentials_of(some_key(), 77));
  CommandKey other = some_key();
  other.robot_id = 43;
  CredentialRecord next = old;
  Credentials read{};
  begin_start(next, read);
  put_key(next, credentials_of(other).key);
  for (int written = 0; written <= kCredentialRecordSize; ++written) {
    CredentialRecord torn = old;
    std::copy_n(next.bytes, written, torn.bytes);
    EXPECT_TRUE(begin_start(torn, read));
    ASSERT_TRUE(read.key_set) << written;
    EXPECT_EQ(command_key_of(read), written < kKeyCopySize ? some_key() : other) << written;
  }
}

TEST(KeyStore, AnErasedEepromHoldsNoKeyAndItsFirstStartIsOne) {
  for (const int byte : {0x00, 0xFF}) {
    CredentialRecord record{};
    std::fill(std::begin(record.bytes), std::end(record.bytes), static_cast<uint8_t>(byte));
    Credentials read{};
    EXPECT_TRUE(begin_start(record, read));
    EXPECT_FALSE(read.key_set);
    EXPECT_EQ(read.boot_epoch, 1);
    // A key is set; the next start has it.
    put_key(record, credentials_of(some_key()).key);
    EXPECT_TRUE(begin_start(record, read));
    EXPECT_TRUE(read.key_set);
    EXPECT_EQ(command_key_of(read), some_key());
    EXPECT_EQ(read.boot_epoch, kFirstBootEpoch);
  }
}

TEST(KeyStore, NoTwoStartsHaveTheSameNumberWhereverPowerFails) {
  CredentialRecord eeprom = credential_record(credentials_of(some_key()));
  uint16_t last = 0;
  for (int start = 0; start < 1200; ++start) {
    CredentialRecord record = eeprom;
    Credentials credentials{};
    ASSERT_TRUE(begin_start(record, credentials));
    const uint8_t slot = epoch_slot_offset(credentials.boot_epoch);
    const int written = start % 5;  // bytes until power fails; 4: it does not
    std::copy_n(record.bytes + slot, written, eeprom.bytes + slot);
    if (written < kEpochSlotSize) continue;  // it accepts no command before its number is written
    ASSERT_TRUE(credentials.key_set);
    ASSERT_GT(credentials.boot_epoch, last);
    last = credentials.boot_epoch;
  }
  EXPECT_GE(last, 200);
}

TEST(KeyStore, WithoutANumberTheKeyIsRefusedUntilItIsSetAnew) {
  CredentialRecord record = credential_record(credentials_of(some_key(), 500));
  std::fill_n(record.bytes + epoch_slot_offset(0), 2 * kEpochSlotSize, static_cast<uint8_t>(0xFF));
  const CredentialRecord eeprom = record;
  Credentials read{};
  EXPECT_FALSE(begin_start(record, read)) << "nothing is written: the next start is not better";
  EXPECT_FALSE(read.key_set);
  record = eeprom;
  EXPECT_FALSE(begin_start(record, read));
  EXPECT_FALSE(read.key_set);
  put_key(record, credentials_of(test_key()).key);
  EXPECT_TRUE(begin_start(record, read));
  EXPECT_TRUE(read.key_set);
  EXPECT_EQ(read.boot_epoch, 2);
}

TEST(KeyStore, TheLastNumberIsTheEnd) {
  CredentialRecord record = credential_record(credentials_of(some_key(), UINT16_MAX));
  Credentials read{};
  EXPECT_TRUE(begin_start(record, read));
  EXPECT_TRUE(read.key_set);
  EXPECT_EQ(read.boot_epoch, UINT16_MAX);
  EXPECT_FALSE(begin_start(record, read));
  EXPECT_FALSE(read.key_set);
}

TEST(KeyStore, LiesBehindTheParameters) {
  EXPECT_GE(kCredentialRecordAddress, parameter_copy_address(kParameterCopies));
  EXPECT_LE(kCredentialRecordAddress + kCredentialRecordSize, 1024) << "the EEPROM's size";
}

}  // namespace
}  // namespace screed
