// Answers to commands in words: state, reason, remedy.
#include "host_sim/ground_station/link/answer_text.h"

#include <gtest/gtest.h>

#include "schema/class_values.h"
#include "tests/unit/host_sim/ground_station/said_frames.h"

namespace screed {
namespace {

using State = message::HeartbeatState;
using Fault = message::HeartbeatFaults;
using Result = message::CommandAckResult;

class AnswerText : public ::testing::Test {
 protected:
  template <class Message>
  void say(const Message& message) {
    const CanFrame frame = frame_of(message);
    robot_.add_frame(kStart_us, frame, *find_message(frame.id));
  }
  std::string text(CommandOp op, Result result, uint16_t detail = 0,
                   CommandStyle style = CommandStyle::kProgram) const {
    return answer_text({static_cast<uint8_t>(op), static_cast<uint8_t>(result), detail}, robot_,
                       kStart_us, style);
  }

  LatestTelemetry robot_;
};

TEST_F(AnswerText, OfAStateThatDoesNotAllowTheCommandNamesTheWayOut) {
  struct Case {
    CommandOp op;
    State state;
    const char* text;
  };
  const Case cases[] = {
      {CommandOp::kRun, State::kDisarmed, "disarmed; arm first: screed send arm"},
      {CommandOp::kRun, State::kRunning, "running already"},
      {CommandOp::kRun, State::kFault,
       "fault (stuck: dug in or hung up for longer than the parameter stuck_time allows); clear it "
       "first: screed send clear"},
      {CommandOp::kArm, State::kStopped, "stopped already"},
      {CommandOp::kArm, State::kArmed, "armed already"},
      {CommandOp::kStop, State::kArmed, "armed; only a running robot can be stopped"},
      {CommandOp::kClear, State::kDisarmed, "disarmed; there is no fault to clear"},
      {CommandOp::kDrive, State::kDisarmed, "disarmed; arm first: screed send arm"},
      {CommandOp::kDrive, State::kArmed, "armed; run first: screed send run"},
      {CommandOp::kDrive, State::kRunning,
       "running the algorithm 'hill sensing'; set the parameter algorithm to drive first"},
      {CommandOp::kParameterCommit, State::kArmed, "armed; disarm first: screed send disarm"},
  };
  message::Leveling leveling{};
  leveling.algorithm = static_cast<uint8_t>(message::LevelingAlgorithm::kHillSensing);
  say(leveling);
  EXPECT_EQ(text(CommandOp::kRun, Result::kWrongState),
            "refused: not possible in the robot's present state");
  for (const Case& it : cases) {
    say(heartbeat(it.state, it.state == State::kFault ? Fault::kStuck : 0));
    EXPECT_EQ(text(it.op, Result::kWrongState), std::string("refused: ") + it.text);
  }
  say(heartbeat(State::kDisarmed, 0));
  EXPECT_EQ(text(CommandOp::kRun, Result::kWrongState, 0, CommandStyle::kKeys),
            "refused: disarmed; arm first (key a)");
}

TEST_F(AnswerText, OfEveryResultIsASentence) {
  EXPECT_EQ(text(CommandOp::kArm, Result::kDone), "done");
  say(message::Power{5800, 0});
  EXPECT_EQ(text(CommandOp::kArm, Result::kFaultPresent, Fault::kBattery | Fault::kGyroFrozen),
            "refused: gyro frozen: the gyro repeats itself to the bit; battery 5.80 V below "
            "battery_low 6.00 V (the default)");
  say(message::Time{2400, 0});
  EXPECT_EQ(text(CommandOp::kArm, Result::kNotReady),
            "refused: start-up needs 4.5 s at rest, 2.1 s left");
  EXPECT_EQ(text(CommandOp::kArm, Result::kLockedOut, 250),
            "refused: too many wrong signatures; locked for 3 s");
  for (int result = 1; result <= message::kCommandAckResultMax; ++result) {
    const std::string words = text(CommandOp::kArm, static_cast<Result>(result));
    EXPECT_EQ(words.rfind("refused: ", 0), 0U) << words;
    EXPECT_EQ(words.find("reason"), std::string::npos) << words;
  }
  EXPECT_EQ(text(CommandOp::kArm, static_cast<Result>(77)), "refused: reason 77");
}

// The refusal was on its way when the robot said that it runs.
TEST_F(AnswerText, OfARobotThatDrivesByNowSaysSo) {
  message::Leveling leveling{};
  leveling.algorithm = static_cast<uint8_t>(message::LevelingAlgorithm::kDrive);
  say(leveling);
  say(heartbeat(State::kRunning, 0));
  EXPECT_EQ(text(CommandOp::kDrive, Result::kWrongState),
            "refused: it was not running yet, and is now; send it again");
}

}  // namespace
}  // namespace screed
