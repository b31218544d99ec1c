// Commands and their answers.
#include <gtest/gtest.h>
#include <deque>

#include "firmware/math/crc16.h"
#include "firmware/protocol/e2e.h"
#include "firmware/security/command_gate.h"
#include "host_sim/ground_station/link/command_session.h"
#include "schema/class_values.h"
#include "tests/unit/host_sim/ground_station/said_frames.h"

namespace screed {

namespace {

// The ground station's side of a link, against a robot's own gate behind a link that can fail.

using Result = message::CommandAckResult;

/// A robot and the link to it: one object, one clock.
class FakeRobot : public Link {
 public:
  explicit FakeRobot(const CommandKey& key)
      : gate_(credentials_of(key, 5)), node_(node_of_robot(key.robot_id)) {}

  void receive(std::chrono::milliseconds wait, std::vector<LinkFrame>& frames) override {
    now_us += static_cast<uint64_t>(wait.count()) * 1000U;
    gate_.tick();
    if (!silent && now_us >= heartbeat_due_us_) {
      heartbeat_due_us_ = now_us + 200'000;
      message::Heartbeat heartbeat{};
      heartbeat.boot_epoch = 5;
      heartbeat.freshness = gate_.counter();
      say(heartbeat);
    }
    for (; !out_.empty(); out_.pop_front()) frames.push_back({now_us, out_.front(), std::nullopt});
  }

  bool send(const CanFrame& frame) override {
    sent.push_back(frame);
    if (lose-- > 0) return true;
    lose = 0;
    if (frame.id == id_of_node(kIdParamStage, node_) && e2e_check(frame.id, frame.data, frame.size))
      stage_ = message::ParamStage::unpack(frame.data);
    if (frame.id != id_of_node(kIdCommand, node_)) return true;
    const GateResult checked = gate_.check(frame.id, frame.data);
    if (checked != GateResult::kRepeated) {
      result_ = checked == GateResult::kAccepted ? execute(frame) : static_cast<Result>(checked);
      if (checked == GateResult::kAccepted) ++done;
    }
    message::CommandAck ack{};
    ack.op = frame.data[0];
    ack.freshness = frame.data[4];
    ack.result = static_cast<uint8_t>(result_);
    if (result_ == Result::kBadMac) ack.detail = gate_.counter();
    say(ack);
    return true;
  }

  const LinkStatus& status() const override { return status_; }
  const std::string& name() const override { return name_; }

  size_t sent_with(uint16_t id) const {
    return static_cast<size_t>(
        std::count_if(sent.begin(), sent.end(), [&](const CanFrame& f) { return f.id == id; }));
  }

  /// What it has said and nobody has heard yet is lost.
  void lose_answers() { out_.clear(); }
  /// Its answer to a command with this number, whether or not there was one.
  void answer(CommandOp op, uint8_t number, Result result) {
    message::CommandAck ack{};
    ack.op = static_cast<uint8_t>(op);
    ack.freshness = number;
    ack.result = static_cast<uint8_t>(result);
    say(ack);
  }
  /// The next bit error hits what it said last.
  void damage_answer() { out_.back().data[out_.back().size - 1] ^= 1U; }

  uint64_t now_us = 0;
  bool silent = false;
  int lose = 0;         ///< this many of the next frames
  int lose_values = 0;  ///< this many values of parameters
  int busy = 0;         ///< this many commits are answered "busy"
  int done = 0;
  std::vector<CanFrame> sent;
  int32_t parameter = 42;

 private:
  template <class Message>
  void say(const Message& message) {
    CanFrame frame = frame_of(message);
    frame.id = id_of_node(frame.id, node_);
    e2e_protect(frame.id, 0, frame.data, frame.size);
    out_.push_back(frame);
  }

  Result execute(const CanFrame& frame) {
    const auto op = static_cast<CommandOp>(frame.data[0]);
    if (op == CommandOp::kRun) return Result::kWrongState;
    if (op == CommandOp::kParameterRead) {
      if (lose_values-- <= 0) say(message::ParamValue{get_u16(frame.data + 1), parameter});
    }
    if (op == CommandOp::kParameterCommit) {
      if (busy-- > 0) return Result::kBusy;
      const CanFrame staged = frame_of(stage_);
      if (stage_.index != frame.data[1] ||
          crc16_ccitt(staged.data + 2, 4) != get_u16(frame.data + 2)) {
        return Result::kBadArgument;
      }
      parameter = stage_.value;
    }
    return Result::kDone;
  }

  CommandGate gate_;
  uint8_t node_;
  Result result_ = Result::kDone;
  message::ParamStage stage_{0xFFFF, 0};
  uint64_t heartbeat_due_us_ = 0;
  std::deque<CanFrame> out_;
  LinkStatus status_;
  std::string name_ = "fake";
};

/// Two robots on one radio channel: both hear all, and the ground hears both.
class TwoRobots : public Link {
 public:
  void receive(std::chrono::milliseconds wait, std::vector<LinkFrame>& frames) override {
    one.receive(wait, frames);
    three.receive(wait, frames);
  }
  bool send(const CanFrame& frame) override { return one.send(frame) && three.send(frame); }
  const LinkStatus& status() const override { return one.status(); }
  const std::string& name() const override { return one.name(); }

  static CommandKey key_of(uint8_t robot_id) {
    CommandKey key = test_key();
    key.robot_id = robot_id;
    return key;
  }

  FakeRobot one{key_of(1)};
  FakeRobot three{key_of(3)};
};

TEST(CommandSessionOfTwo, CommandsAndParametersReachTheRobotOfTheKeyAlone) {
  TwoRobots robots;
  robots.one.parameter = 10;
  robots.three.parameter = 30;
  CommandSession session{robots,
                         {TwoRobots::key_of(3), true, {}, [&] { return robots.one.now_us; }}};
  EXPECT_EQ(session.node(), 3);
  const auto answer = session.run(CommandOp::kArm);
  ASSERT_TRUE(answer.has_value());
  EXPECT_TRUE(answer->done());
  std::optional<CommandAnswer> read;
  EXPECT_EQ(session.read_parameter(7, read), 30);
  const auto written = session.write_parameter(7, 31);
  ASSERT_TRUE(written.has_value());
  EXPECT_TRUE(written->done());
  EXPECT_EQ(robots.three.parameter, 31);
  EXPECT_EQ(robots.one.parameter, 10);
  EXPECT_EQ(robots.one.done, 0);
}

TEST(CommandSessionOfTwo, IsNotReadyByTheOtherRobotsHeartbeat) {
  TwoRobots robots;
  robots.three.silent = true;
  CommandSession session{robots,
                         {TwoRobots::key_of(3), true, {}, [&] { return robots.one.now_us; }}};
  EXPECT_FALSE(session.run(CommandOp::kArm).has_value());
  EXPECT_FALSE(session.ready());
  EXPECT_EQ(robots.one.sent_with(kIdCommand), 0U);
}

class CommandSessionTest : public ::testing::Test {
 protected:
  /// Until the robot is heard.
  void hear() {
    while (!session_.ready()) step();
  }
  void step() { session_.pump(std::chrono::milliseconds(20)); }
  /// Of the command that was sent last.
  uint8_t last_number() const {
    const auto last = std::find_if(robot_.sent.rbegin(), robot_.sent.rend(),
                                   [](const CanFrame& f) { return f.id == kIdCommand; });
    return last->data[kCommandFreshnessOffset];
  }

  FakeRobot robot_{test_key()};
  /// Another ground station has the key too, and hears as much.
  CommandSigner other_{test_key()};
  CommandSession session_{
      robot_,
      {test_key(), true, [this](const LinkFrame& frame) { other_.handle_frame(frame.frame); },
       [this] { return robot_.now_us; }}};
};

TEST_F(CommandSessionTest, ACommandWaitsForTheRobotsHeartbeatAndIsAnswered) {
  session_.start(CommandOp::kArm);
  EXPECT_TRUE(robot_.sent.empty());
  const auto answer = session_.run(CommandOp::kArm);
  ASSERT_TRUE(answer.has_value());
  EXPECT_TRUE(answer->done());
  EXPECT_EQ(robot_.done, 1);
}

TEST_F(CommandSessionTest, ARefusalComesBackWithItsReason) {
  const auto answer = session_.run(CommandOp::kRun);
  ASSERT_TRUE(answer.has_value());
  EXPECT_FALSE(answer->done());
  EXPECT_EQ(answer->op, static_cast<uint8_t>(CommandOp::kRun));
  EXPECT_EQ(answer->result, static_cast<uint8_t>(Result::kWrongState));
}

TEST_F(CommandSessionTest, HeartbeatsGoFiveTimesASecond) {
  while (robot_.now_us < 10'000'000) session_.pump(std::chrono::milliseconds(20));
  EXPECT_NEAR(static_cast<double>(robot_.sent_with(kIdGroundHeartbeat)), 50.0, 1.0);
  // And their counters step, or the robot takes the sender for dead.
  EXPECT_NE(robot_.sent[0].data[1] & 0xF, robot_.sent[1].data[1] & 0xF);
  FakeRobot other{test_key()};
  CommandSession listener{other, {test_key(), false, {}, [&] { return other.now_us; }}};
  while (other.now_us < 1'000'000) listener.pump(std::chrono::milliseconds(20));
  EXPECT_TRUE(other.sent.empty());
}

TEST_F(CommandSessionTest, ALostCommandIsRepeatedAndDoneOnce) {
  session_.pump(std::chrono::milliseconds(20));
  session_.pump(std::chrono::milliseconds(20));
  robot_.lose = 3;
  const auto answer = session_.run(CommandOp::kArm);
  ASSERT_TRUE(answer.has_value());
  EXPECT_TRUE(answer->done());
  EXPECT_EQ(robot_.done, 1);
  EXPECT_GT(robot_.sent_with(kIdCommand), 1U);
}

// Another ground station has the key too, and both sign with the next number.
TEST_F(CommandSessionTest, WhereSomebodyElseWasFasterItIsSignedAnew) {
  CommandSigner other(test_key());
  bool commanded = false;
  CommandSession session(robot_, {test_key(), true,
                                  [&](const LinkFrame& frame) {
                                    other.handle_frame(frame.frame);
                                    if (commanded || !other.ready()) return;
                                    commanded = true;
                                    robot_.send(other.sign(CommandOp::kDisarm));
                                  },
                                  [this] { return robot_.now_us; }});
  const auto answer = session.run(CommandOp::kArm);
  ASSERT_TRUE(answer.has_value());
  EXPECT_TRUE(answer->done());
  EXPECT_EQ(answer->op, static_cast<uint8_t>(CommandOp::kArm));
  EXPECT_EQ(robot_.done, 2);
  EXPECT_EQ(robot_.sent_with(kIdCommand), 3U) << "of its own two: in vain, and anew";
}

// Its answers say which numbers are gone, five times as soon as its heartbeats.
TEST_F(CommandSessionTest, WhatOthersCommandedIsHeardOfTheRobotsAnswers) {
  session_.pump(std::chrono::milliseconds(20));
  CommandSigner other(test_key());
  while (!other.ready()) {
    std::vector<LinkFrame> frames;
    robot_.receive(std::chrono::milliseconds(20), frames);
    for (const LinkFrame& frame : frames) other.handle_frame(frame.frame);
  }
  for (int i = 0; i < 3; ++i) robot_.send(other.sign(CommandOp::kDisarm));
  robot_.silent = true;
  const auto answer = session_.run(CommandOp::kArm);
  ASSERT_TRUE(answer.has_value());
  EXPECT_TRUE(answer->done());
  EXPECT_EQ(robot_.sent_with(kIdCommand), 4U);
}

// A radio doubles packets: the first command's answer comes once more while the second one waits
// for its own.
TEST_F(CommandSessionTest, TheAnswerToAnEarlierCommandIsNotTakenForThisOnes) {
  hear();
  ASSERT_TRUE(session_.run(CommandOp::kArm).has_value());
  const uint8_t first = last_number();
  session_.start(CommandOp::kArm);
  step();
  EXPECT_EQ(last_number(), first + 1);
  robot_.lose_answers();
  robot_.answer(CommandOp::kArm, first, Result::kWrongState);
  step();
  EXPECT_TRUE(session_.waiting());
  EXPECT_FALSE(session_.take_answer().has_value());
  while (session_.waiting()) step();
  const auto answer = session_.take_answer();
  ASSERT_TRUE(answer.has_value());
  EXPECT_TRUE(answer->done());
  EXPECT_EQ(robot_.done, 2) << "repeated, not signed anew";
}

TEST_F(CommandSessionTest, AnAnswerThatNobodyTookIsNotTheNextCommands) {
  hear();
  session_.start(CommandOp::kArm);
  while (session_.waiting()) step();
  session_.start(CommandOp::kDisarm);
  EXPECT_FALSE(session_.take_answer().has_value());
  while (session_.waiting()) step();
  EXPECT_EQ(session_.take_answer().value_or(CommandAnswer{}).op,
            static_cast<uint8_t>(CommandOp::kDisarm));
  EXPECT_FALSE(session_.take_answer().has_value()) << "once";
}

TEST_F(CommandSessionTest, ADamagedAnswerIsNone) {
  hear();
  session_.start(CommandOp::kArm);
  step();
  robot_.lose_answers();
  robot_.answer(CommandOp::kArm, last_number(), Result::kDone);
  robot_.damage_answer();
  step();
  EXPECT_TRUE(session_.waiting());
}

TEST_F(CommandSessionTest, AfterItWasGivenUpNoAnswerCounts) {
  hear();
  session_.start(CommandOp::kArm);
  step();  // sent; its answer is heard in the next step
  session_.give_up();
  step();
  EXPECT_FALSE(session_.take_answer().has_value());
}

TEST_F(CommandSessionTest, ANewCommandGoesAtOnceAndARepetitionAfterThreeTenths) {
  hear();
  ASSERT_TRUE(session_.run(CommandOp::kArm).has_value());
  const size_t before = robot_.sent_with(kIdCommand);
  session_.start(CommandOp::kDisarm);
  step();
  EXPECT_EQ(robot_.sent_with(kIdCommand), before + 1);
  robot_.lose_answers();
  const uint64_t sent_us = robot_.now_us;
  while (robot_.now_us < sent_us + 280'000) step();
  EXPECT_EQ(robot_.sent_with(kIdCommand), before + 1);
  step();
  EXPECT_EQ(robot_.sent_with(kIdCommand), before + 2);
}

// Nothing but the refusal of its signature says that the number is gone.
TEST_F(CommandSessionTest, WhereTheOthersAnswerIsLostItIsSignedAnew) {
  hear();
  robot_.send(other_.sign(CommandOp::kDisarm));
  robot_.lose_answers();
  const auto answer = session_.run(CommandOp::kArm);
  ASSERT_TRUE(answer.has_value());
  EXPECT_TRUE(answer->done());
  EXPECT_EQ(robot_.done, 2);
}

// Its own is lost, the other's of that number and a later one are taken: it is signed anew at once,
// not refused first.
TEST_F(CommandSessionTest, WhereOthersAnswersSayThatItsNumberIsGoneItIsSignedAnewAtOnce) {
  hear();
  for (const int others : {1, 2}) {
    robot_.lose = 1;
    session_.start(CommandOp::kArm);
    step();
    const size_t before = robot_.sent_with(kIdCommand);
    const uint8_t first = last_number();
    for (int i = 0; i < others; ++i) {
      robot_.lose_answers();
      robot_.send(other_.sign(CommandOp::kDisarm));
    }
    const uint8_t taken = last_number();
    EXPECT_EQ(taken, first + others - 1);
    step();
    EXPECT_EQ(robot_.sent_with(kIdCommand), before + static_cast<size_t>(others) + 1) << others;
    EXPECT_EQ(last_number(), taken + 1) << others;
    while (session_.waiting()) step();
    EXPECT_TRUE(session_.take_answer().value_or(CommandAnswer{0, 1, 0}).done());
  }
}

// It was taken, its answer is lost; signed anew it would be done twice.
TEST_F(CommandSessionTest, ARefusedSignatureOfSomebodyElseChangesNothing) {
  hear();
  session_.start(CommandOp::kArm);
  step();
  EXPECT_EQ(robot_.done, 1);
  const uint8_t number = last_number();
  robot_.lose_answers();
  robot_.answer(CommandOp::kDisarm, number, Result::kBadMac);
  while (session_.waiting()) step();
  EXPECT_EQ(last_number(), number);
  EXPECT_EQ(robot_.done, 1);
}

TEST_F(CommandSessionTest, SilenceEndsAfterAWhile) {
  robot_.silent = true;
  EXPECT_FALSE(session_.run(CommandOp::kArm).has_value());
  EXPECT_LT(robot_.now_us, 4'000'000U);
  EXPECT_EQ(robot_.sent_with(kIdCommand), 0U);
}

TEST_F(CommandSessionTest, WaitingEndsWhenItIsToldTo) {
  struct Ended {};
  robot_.silent = true;
  const auto after_a_second = [this] {
    if (robot_.now_us >= 1'000'000) throw Ended();
  };
  CommandSession session{robot_,
                         {test_key(), true, {}, [this] { return robot_.now_us; }, after_a_second}};
  std::optional<CommandAnswer> answer;
  EXPECT_THROW(session.run(CommandOp::kArm), Ended);
  EXPECT_EQ(robot_.now_us, 1'000'000U);
  EXPECT_THROW(session.read_parameter(3, answer), Ended);
  EXPECT_THROW(session.write_parameter(3, 7), Ended);
  EXPECT_EQ(robot_.now_us, 1'000'000U);
}

TEST_F(CommandSessionTest, AnotherKeyIsRefused) {
  CommandKey other = test_key();
  other.bytes[0] ^= 1U;
  CommandSession session{robot_, {other, true, {}, [this] { return robot_.now_us; }}};
  const auto answer = session.run(CommandOp::kArm);
  ASSERT_TRUE(answer.has_value());
  EXPECT_EQ(answer->result, static_cast<uint8_t>(Result::kBadMac));
  EXPECT_EQ(robot_.done, 0);
}

TEST_F(CommandSessionTest, ParametersAreReadAndWritten) {
  std::optional<CommandAnswer> answer;
  EXPECT_EQ(session_.read_parameter(3, answer), 42);
  robot_.busy = 2;
  answer = session_.write_parameter(3, -7);
  ASSERT_TRUE(answer.has_value());
  EXPECT_TRUE(answer->done());
  EXPECT_EQ(robot_.parameter, -7);
  EXPECT_EQ(session_.read_parameter(3, answer), -7);
}

TEST_F(CommandSessionTest, AStagingThatIsLostIsSentAgain) {
  session_.pump(std::chrono::milliseconds(20));
  session_.pump(std::chrono::milliseconds(20));
  robot_.lose = 1;
  const auto answer = session_.write_parameter(3, 1000);
  ASSERT_TRUE(answer.has_value());
  EXPECT_TRUE(answer->done());
  EXPECT_EQ(robot_.parameter, 1000);
}

// Staging and commit are lost together, and no refusal tells.
TEST_F(CommandSessionTest, AStagingGoesBeforeEachRepetitionOfItsCommit) {
  hear();
  session_.start_write(3, 1000);
  robot_.lose = 2;
  while (session_.waiting()) step();
  const auto answer = session_.take_answer();
  ASSERT_TRUE(answer.has_value());
  EXPECT_TRUE(answer->done());
  EXPECT_EQ(robot_.parameter, 1000);
  EXPECT_EQ(robot_.sent_with(kIdParamStage), 2U);
  EXPECT_EQ(robot_.sent_with(kIdCommand), 2U);
  // And before no other command.
  ASSERT_TRUE(session_.run(CommandOp::kArm).has_value());
  EXPECT_EQ(robot_.sent_with(kIdParamStage), 2U);
}

TEST_F(CommandSessionTest, AParameterThatIsNoneIsStagedThreeTimes) {
  hear();
  // No index beyond 255 fits into the commit.
  const auto answer = session_.write_parameter(0x103, 1);
  ASSERT_TRUE(answer.has_value());
  EXPECT_EQ(answer->result, static_cast<uint8_t>(Result::kBadArgument));
  EXPECT_EQ(robot_.sent_with(kIdParamStage), 3U);
  EXPECT_EQ(robot_.sent_with(kIdCommand), 3U);
}

// It stores a parameter for 2 s.
TEST_F(CommandSessionTest, ABusyRobotIsAskedForLongerThanItStores) {
  hear();
  robot_.busy = 1000;
  const uint64_t begin_us = robot_.now_us;
  const auto answer = session_.write_parameter(3, 1);
  ASSERT_TRUE(answer.has_value());
  EXPECT_EQ(answer->result, static_cast<uint8_t>(Result::kBusy));
  EXPECT_GT(robot_.now_us, begin_us + 3'000'000);
  EXPECT_LT(robot_.now_us, begin_us + 6'000'000);
}

TEST_F(CommandSessionTest, AValueThatIsLostIsReadAgainNotRemembered) {
  std::optional<CommandAnswer> answer;
  EXPECT_EQ(session_.read_parameter(3, answer), 42);
  robot_.parameter = 43;
  robot_.lose_values = 1;
  EXPECT_EQ(session_.read_parameter(3, answer), 43);
  robot_.lose_values = 1000;
  EXPECT_FALSE(session_.read_parameter(3, answer).has_value());
  EXPECT_TRUE(answer.has_value() && answer->done()) << "it did answer";
}

TEST_F(CommandSessionTest, AfterTheEmergencyStopNothingIsRepeatedOrAnswered) {
  hear();
  session_.start(CommandOp::kArm);
  while (session_.waiting()) step();
  session_.emergency_stop();
  EXPECT_FALSE(session_.take_answer().has_value());
  robot_.lose = 1;
  session_.start(CommandOp::kRun);
  step();
  const size_t before = robot_.sent_with(kIdCommand);
  session_.emergency_stop();
  EXPECT_FALSE(session_.waiting());
  const uint64_t begin_us = robot_.now_us;
  while (robot_.now_us < begin_us + 1'000'000) step();
  EXPECT_EQ(robot_.sent_with(kIdCommand), before);
}

TEST_F(CommandSessionTest, TheEmergencyStopNeedsNoRobot) {
  session_.emergency_stop();
  EXPECT_EQ(robot_.sent_with(kIdEmergencyStop), 3U);
  EXPECT_TRUE(e2e_check(kIdEmergencyStop, robot_.sent[0].data, robot_.sent[0].size));
}

// Answers to commands in words: state, reason, remedy.

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
