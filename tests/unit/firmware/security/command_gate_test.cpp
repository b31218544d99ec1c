// Who gets through the gate: the holder of the key, once a command, in order.
#include "firmware/security/command_gate.h"

#include <gtest/gtest.h>

#include <vector>

#include "host_sim/core/random.h"
#include "host_sim/ground_station/station/command_signer.h"

namespace screed {
namespace {

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

}  // namespace
}  // namespace screed
