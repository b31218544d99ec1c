// Replayed commands against the gate, in numbers. SCREED_REPLAYS sets how many
// (docs/studies/protocol.md names the figure for ten million).
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "firmware/security/command_gate.h"
#include "host_sim/core/random.h"
#include "host_sim/ground_station/station/command_key.h"

namespace screed {
namespace {

uint64_t replays() {
  const char* text = std::getenv("SCREED_REPLAYS");
  return text == nullptr ? 100'000U : std::strtoull(text, nullptr, 10);
}

/// Commands as somebody recorded them: those of three starts before, and of this one.
class Recorded {
 public:
  static constexpr uint16_t kEpoch = 40;
  static constexpr int kOfAStart = 2000;

  Recorded() : gate(credentials_of(test_key(), kEpoch)) {
    for (uint16_t epoch = kEpoch - 3; epoch <= kEpoch; ++epoch) {
      CommandSigner signer(test_key());
      message::Heartbeat heartbeat{};
      heartbeat.boot_epoch = epoch;
      signer.handle_frame(frame_of(heartbeat));
      for (int i = 0; i < kOfAStart; ++i) {
        frames.push_back(signer.sign(CommandOp::kArm));
        if (epoch == kEpoch) gate.check(kIdCommand, frames.back().data);
      }
    }
    EXPECT_EQ(gate.counter(), kOfAStart);
  }

  CommandGate gate;  ///< has accepted those of this start
  std::vector<CanFrame> frames;
};

TEST(Replay, NoRecordedCommandIsAccepted) {
  Recorded recorded;
  WorldRandom random(1, "replay");
  uint64_t accepted = 0;
  uint64_t repeated = 0;
  // One in each tick, which is more than the radio carries beside everything else.
  for (uint64_t i = 0; i < replays(); ++i) {
    const CanFrame& frame = recorded.frames.at(random.next() % recorded.frames.size());
    const GateResult result = recorded.gate.check(kIdCommand, frame.data);
    accepted += result == GateResult::kAccepted ? 1 : 0;
    repeated += result == GateResult::kRepeated ? 1 : 0;
    recorded.gate.tick();
  }
  std::printf("%llu replayed commands, one a tick: %llu accepted, %llu answered as a repetition\n",
              static_cast<unsigned long long>(replays()), static_cast<unsigned long long>(accepted),
              static_cast<unsigned long long>(repeated));
  EXPECT_EQ(accepted, 0U);
}

TEST(Replay, TheMacAloneLetsThroughNoMoreThanChance) {
  const Recorded recorded;
  WorldRandom random(2, "replay");
  CommandSigner signer(test_key());
  message::Heartbeat heartbeat{};
  heartbeat.boot_epoch = Recorded::kEpoch;
  heartbeat.freshness = Recorded::kOfAStart;
  signer.handle_frame(frame_of(heartbeat));
  CommandGate gate = recorded.gate;
  uint64_t accepted = 0;
  for (uint64_t i = 0; i < replays(); ++i) {
    // The robot goes on with its work, so that a recorded command meets a new counter every time.
    if (i % 500 == 0 && gate.counter() < 60000) {
      ASSERT_EQ(gate.check(kIdCommand, signer.sign(CommandOp::kDrive).data), GateResult::kAccepted);
    }
    CommandGate unlocked = gate;  // with all its patience
    const CanFrame& frame = recorded.frames.at(random.next() % recorded.frames.size());
    accepted += unlocked.check(kIdCommand, frame.data) == GateResult::kAccepted ? 1 : 0;
  }
  const double expected = static_cast<double>(replays()) / 16777216.0;
  std::printf("%llu replayed commands without lock-out: %llu accepted, %.2f by chance\n",
              static_cast<unsigned long long>(replays()), static_cast<unsigned long long>(accepted),
              expected);
  EXPECT_LE(static_cast<double>(accepted), 4.0 * expected + 3.0);
}

}  // namespace
}  // namespace screed
