// The security of commands: MAC, gate, key.
#include <gtest/gtest.h>
#include <algorithm>
#include <array>
#include <cstdio>
#include <numeric>
#include <string>
#include <vector>

#include "firmware/math/crc16.h"
#include "firmware/parameters/parameter_store.h"
#include "firmware/security/command_gate.h"
#include "firmware/security/command_mac.h"
#include "firmware/security/key_store.h"
#include "host_sim/core/random.h"
#include "host_sim/ground_station/station/command_key.h"

namespace screed {

namespace {

// SipHash-2-4 against the 64 vectors its authors publish (vectors.h of their reference
// implementation): key 00 01 .. 0F, message 00 01 .. of every length from 0 to 63. OpenSSL gives
// the same: openssl mac -macopt hexkey:000102030405060708090a0b0c0d0e0f -macopt size:8 SIPHASH

constexpr std::array<const char*, 64> kVectors = {
    "310E0EDD47DB6F72", "FD67DC93C539F874", "5A4FA9D909806C0D", "2D7EFBD796666785",
    "B7877127E09427CF", "8DA699CD64557618", "CEE3FE586E46C9CB", "37D1018BF50002AB",
    "6224939A79F5F593", "B0E4A90BDF82009E", "F3B9DD94C5BB5D7A", "A7AD6B22462FB3F4",
    "FBE50E86BC8F1E75", "903D84C02756EA14", "EEF27A8E90CA23F7", "E545BE4961CA29A1",
    "DB9BC2577FCC2A3F", "9447BE2CF5E99A69", "9CD38D96F0B3C14B", "BD6179A71DC96DBB",
    "98EEA21AF25CD6BE", "C7673B2EB0CBF2D0", "883EA3E395675393", "C8CE5CCD8C030CA8",
    "94AF49F6C650ADB8", "EAB8858ADE92E1BC", "F315BB5BB835D817", "ADCF6B0763612E2F",
    "A5C91DA7ACAA4DDE", "716595876650A2A6", "28EF495C53A387AD", "42C341D8FA92D832",
    "CE7CF2722F512771", "E37859F94623F3A7", "381205BB1AB0E012", "AE97A10FD434E015",
    "B4A31508BEFF4D31", "81396229F0907902", "4D0CF49EE5D4DCCA", "5C73336A76D8BF9A",
    "D0A704536BA93E0E", "925958FCD6420CAD", "A915C29BC8067318", "952B79F3BC0AA6D4",
    "F21DF2E41D4535F9", "87577519048F53A9", "10A56CF5DFCD9ADB", "EB75095CCD986CD0",
    "51A9CB9ECBA312E6", "96AFADFC2CE666C7", "72FE52975A4364EE", "5A1645B276D592A1",
    "B274CB8EBF87870A", "6F9BB4203DE7B381", "EAECB2A30B22A87F", "9924A43CC1315724",
    "BD838D3AAFBF8DB7", "0B1A2A3265D51AEA", "135079A3231CE660", "932B2846E4D70666",
    "E1915F5CB1ECA46C", "F325965CA16D629F", "575FF28E60381BE5", "724506EB4C328A95",
};

TEST(SipHash, PublishedVectors) {
  std::array<uint8_t, kSipHashKeySize> key{};
  std::iota(key.begin(), key.end(), uint8_t{0});
  std::array<uint8_t, 64> message{};
  std::iota(message.begin(), message.end(), uint8_t{0});
  for (size_t size = 0; size < kVectors.size(); ++size) {
    std::array<uint8_t, kSipHashSize> hash{};
    siphash_2_4(key.data(), message.data(), static_cast<uint8_t>(size), hash.data());
    std::string text;
    for (const uint8_t byte : hash) {
      char digits[3];
      std::snprintf(digits, sizeof digits, "%02X", static_cast<unsigned>(byte));
      text += digits;
    }
    EXPECT_EQ(text, kVectors.at(size)) << "message of " << static_cast<int>(size);
  }
}

// Who gets through the gate: the holder of the key, once a command, in order.

/// The robot's heartbeat as far as the signer reads it.
CanFrame heartbeat(uint16_t epoch, uint16_t counter) {
  message::Heartbeat heartbeat{};
  heartbeat.boot_epoch = epoch;
  heartbeat.freshness = counter;
  return frame_of(heartbeat);
}

struct Pair {
  explicit Pair(uint16_t epoch = 7, const CommandKey& key = test_key())
      : gate(credentials_of(key, epoch)), signer(key) {
    signer.handle_frame(heartbeat(epoch, 0));
  }
  GateResult check(const CanFrame& frame) { return gate.check(frame.id, frame.data); }
  GateResult send(CommandOp op = CommandOp::kArm) { return check(signer.sign(op)); }

  CommandGate gate;
  CommandSigner signer;
};

TEST(CommandGate, AcceptsWhatTheSignerSignsInOrder) {
  Pair pair;
  for (int i = 1; i <= 1000; ++i) {
    ASSERT_EQ(pair.send(), GateResult::kAccepted) << i;
    ASSERT_EQ(pair.gate.counter(), i);
  }
}

TEST(CommandGate, TheMacIsOverIdRobotEpochCounterAndData) {
  const Pair pair;
  const CanFrame good = Pair().signer.sign(CommandOp::kDrive, DriveArgument{100, -200});
  for (int bit = 0; bit < 64; ++bit) {
    CanFrame frame = good;
    frame.data[bit / 8] = static_cast<uint8_t>(frame.data[bit / 8] ^ (1U << (bit % 8)));
    CommandGate gate = pair.gate;
    EXPECT_EQ(gate.check(frame.id, frame.data), GateResult::kBadMac) << bit;
  }
  CommandGate gate = pair.gate;
  EXPECT_EQ(gate.check(kIdCommand + 0x10, good.data), GateResult::kBadMac);

  CommandKey other = test_key();
  other.robot_id = 2;
  EXPECT_EQ(Pair(7, other).check(good), GateResult::kBadMac);
  EXPECT_EQ(Pair(8).check(good), GateResult::kBadMac);
  other = test_key();
  other.bytes[15] ^= 1U;
  EXPECT_EQ(Pair(7, other).check(good), GateResult::kBadMac);
  EXPECT_EQ(Pair(7).check(good), GateResult::kAccepted);
}

TEST(CommandGate, WithoutAKeyNothingPasses) {
  Credentials none = credentials_of(test_key());
  none.key_set = false;
  CommandGate gate(none);
  CommandSigner signer(test_key());
  signer.handle_frame(heartbeat(1, 0));
  EXPECT_EQ(gate.check(kIdCommand, signer.sign(CommandOp::kArm).data), GateResult::kNoKey);
  EXPECT_EQ(gate.counter(), 0);
}

TEST(CommandGate, TheLastCommandAgainIsARepetitionAndAnOlderOneIsWrong) {
  Pair pair;
  const CanFrame first = pair.signer.sign(CommandOp::kArm);
  const CanFrame second = pair.signer.sign(CommandOp::kRun);
  EXPECT_EQ(pair.check(first), GateResult::kAccepted);
  EXPECT_EQ(pair.check(first), GateResult::kRepeated);
  EXPECT_EQ(pair.check(second), GateResult::kAccepted);
  EXPECT_EQ(pair.check(second), GateResult::kRepeated);
  EXPECT_EQ(pair.check(first), GateResult::kBadMac);
  EXPECT_EQ(pair.gate.counter(), 2);
}

TEST(CommandGate, LostCommandsDoNotMatterUpTo255InARow) {
  Pair pair;
  for (int i = 0; i < 255; ++i) pair.signer.sign(CommandOp::kStop);
  EXPECT_EQ(pair.send(), GateResult::kAccepted);
  EXPECT_EQ(pair.gate.counter(), 256);
  for (int i = 0; i < 256; ++i) pair.signer.sign(CommandOp::kStop);
  EXPECT_EQ(pair.send(), GateResult::kBadMac);
}

TEST(CommandGate, TheSignerFollowsTheRobot) {
  Pair pair;
  // Another ground station has sent 1000 commands meanwhile.
  CommandSigner other(test_key());
  other.handle_frame(heartbeat(7, 0));
  for (int i = 0; i < 1000; ++i) pair.check(other.sign(CommandOp::kStop));
  pair.signer.handle_frame(heartbeat(7, pair.gate.counter()));
  EXPECT_EQ(pair.send(), GateResult::kAccepted);
  // A heartbeat that was sent before the last command does not set it back.
  pair.signer.handle_frame(heartbeat(7, 1000));
  EXPECT_EQ(pair.send(), GateResult::kAccepted);
  // Nothing got through for long: it begins again where the robot is.
  for (int i = 0; i < 300; ++i) pair.signer.sign(CommandOp::kStop);
  pair.signer.handle_frame(heartbeat(7, pair.gate.counter()));
  EXPECT_EQ(pair.send(), GateResult::kAccepted);
  // The robot was restarted.
  pair.gate = CommandGate(credentials_of(test_key(), 8));
  EXPECT_EQ(pair.send(), GateResult::kBadMac);
  pair.signer.handle_frame(heartbeat(8, 0));
  EXPECT_EQ(pair.send(), GateResult::kAccepted);
}

TEST(CommandGate, EightWrongMacsShutItFor30Seconds) {
  Pair pair;
  CanFrame wrong = pair.signer.sign(CommandOp::kArm);
  wrong.data[7] ^= 0x80U;
  for (int i = 0; i < CommandGate::kMaxBadMacs; ++i) {
    EXPECT_EQ(pair.check(wrong), GateResult::kBadMac);
  }
  EXPECT_EQ(pair.send(), GateResult::kLockedOut);
  for (int tick = 1; tick < CommandGate::kLockoutTicks; ++tick) pair.gate.tick();
  EXPECT_EQ(pair.send(), GateResult::kLockedOut);
  pair.gate.tick();
  EXPECT_EQ(pair.send(), GateResult::kAccepted);
  EXPECT_EQ(pair.gate.refused(), CommandGate::kMaxBadMacs);
}

TEST(CommandGate, AWrongMacNowAndThenIsForgiven) {
  Pair pair;
  CanFrame wrong = pair.signer.sign(CommandOp::kArm);
  wrong.data[7] ^= 0x80U;
  for (int i = 0; i < 100; ++i) {
    ASSERT_EQ(pair.check(wrong), GateResult::kBadMac) << i;
    for (int tick = 0; tick < CommandGate::kBadMacDecayTicks; ++tick) pair.gate.tick();
  }
  // Right ones in between do not make more guesses possible.
  int guesses = 0;
  for (int tick = 0; tick < 60000; ++tick) {
    pair.gate.tick();
    guesses += pair.check(wrong) == GateResult::kBadMac ? 1 : 0;
    if (tick % 25 == 0) pair.send();
  }
  EXPECT_LE(guesses, 200);  // of 60,000 in ten minutes
}

TEST(CommandGate, TheCounterDoesNotWrap) {
  Pair pair;
  for (int i = 0; i < 65535; ++i) ASSERT_EQ(pair.send(), GateResult::kAccepted) << i;
  EXPECT_EQ(pair.gate.counter(), 65535);
  CanFrame frame{kIdCommand, 8, {}};
  for (int low = 0; low < 256; ++low) {
    frame.data[kCommandFreshnessOffset] = static_cast<uint8_t>(low);
    EXPECT_EQ(pair.check(frame), GateResult::kUsedUp);
  }
}

/// Wrong MACs until the gate is shut, by a copy of it.
int guesses_left(CommandGate gate, const CanFrame& wrong) {
  int guesses = 0;
  while (gate.check(wrong.id, wrong.data) == GateResult::kBadMac) ++guesses;
  return guesses;
}

TEST(CommandGate, OneWrongMacIsForgivenEveryFourSecondsFromTheFirstOn) {
  Pair pair;
  CanFrame wrong = pair.signer.sign(CommandOp::kArm);
  wrong.data[7] ^= 0x80U;
  const auto wait = [&](int ticks) {
    for (int tick = 0; tick < ticks; ++tick) pair.gate.tick();
  };
  EXPECT_EQ(guesses_left(pair.gate, wrong), 8);
  pair.check(wrong);
  wait(390);
  pair.check(wrong);  // does not put off the first one's
  pair.check(wrong);
  wait(9);
  EXPECT_EQ(guesses_left(pair.gate, wrong), 5);
  wait(1);
  EXPECT_EQ(guesses_left(pair.gate, wrong), 6);
  wait(399);
  EXPECT_EQ(guesses_left(pair.gate, wrong), 6);
  wait(1);
  EXPECT_EQ(guesses_left(pair.gate, wrong), 7);
  wait(400);
  EXPECT_EQ(guesses_left(pair.gate, wrong), 8);
}

TEST(CommandGate, AGateThatOpensAgainForgivesAsManyAsANewOne) {
  Pair pair;
  CanFrame wrong = pair.signer.sign(CommandOp::kArm);
  wrong.data[7] ^= 0x80U;
  for (int round = 0; round < 3; ++round) {
    ASSERT_EQ(guesses_left(pair.gate, wrong), CommandGate::kMaxBadMacs) << round;
    for (int i = 0; i < CommandGate::kMaxBadMacs; ++i) pair.check(wrong);
    for (int tick = 0; tick < CommandGate::kLockoutTicks; ++tick) pair.gate.tick();
  }
}

// Key and boot epoch as bytes of an EEPROM.

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
