// Commands through the whole core: who may, when, and what the robot answers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <numbers>
#include <optional>

#include "firmware/math/crc16.h"
#include "firmware/parameters/parameter_store.h"
#include "firmware/parameters/parameters.h"
#include "tests/unit/test_robot.h"

namespace screed {
namespace {

constexpr uint8_t kTiltLimit = Parameters::k_tilt_limit;
constexpr uint8_t kSpeedKp = Parameters::k_speed_kp;
constexpr uint8_t kAlgorithm = Parameters::k_algorithm;

/// A robot that waits to be armed.
TestRobot ready_robot(const Parameters& parameters = {}) {
  TestRobot robot(parameters);
  robot.run(600);
  return robot;
}

/// The result of a command, by the answer it gets.
RequestResult result_of(TestRobot& robot, const CanFrame& command) {
  robot.send(command);
  const auto answer = robot.answer();
  EXPECT_TRUE(answer.has_value());
  if (!answer.has_value()) return RequestResult::kDone;
  EXPECT_EQ(answer->op, command.data[0]);
  EXPECT_EQ(answer->freshness, command.data[kCommandFreshnessOffset]);
  return static_cast<RequestResult>(answer->result);
}
RequestResult result_of(TestRobot& robot, CommandOp op) {
  return result_of(robot, robot.command(op));
}

TEST(Command, ArmRunStopDisarm) {
  TestRobot robot = ready_robot();
  EXPECT_EQ(result_of(robot, CommandOp::kRun), RequestResult::kWrongState);
  EXPECT_EQ(result_of(robot, CommandOp::kArm), RequestResult::kDone);
  EXPECT_EQ(robot.state(), RobotState::kArmed);
  EXPECT_EQ(result_of(robot, CommandOp::kRun), RequestResult::kDone);
  EXPECT_EQ(robot.state(), RobotState::kRunning);
  EXPECT_EQ(result_of(robot, CommandOp::kStop), RequestResult::kDone);
  EXPECT_EQ(result_of(robot, CommandOp::kDisarm), RequestResult::kDone);
  EXPECT_EQ(robot.state(), RobotState::kDisarmed);
  EXPECT_EQ(result_of(robot, static_cast<CommandOp>(99)), RequestResult::kBadArgument);
}

TEST(Command, WithoutTheKeyNothingMovesAndTheReasonIsSaid) {
  TestRobot robot = ready_robot();
  CommandKey other = test_key();
  other.bytes[3] ^= 1U;
  robot.signer = CommandSigner(other);
  message::Heartbeat heartbeat{};
  heartbeat.boot_epoch = kFirstBootEpoch;
  robot.signer.handle_frame(frame_of(heartbeat));
  for (const CommandOp op : {CommandOp::kArm, CommandOp::kRun, CommandOp::kParameterRead}) {
    EXPECT_EQ(result_of(robot, op), RequestResult::kBadMac);
  }
  EXPECT_EQ(robot.state(), RobotState::kDisarmed);

  TestRobot keyless;
  Credentials none{};
  keyless.robot = Robot(kBoard, Parameters{}, none);
  keyless.run(600);
  EXPECT_EQ(result_of(keyless, CommandOp::kArm), RequestResult::kNoKey);
  EXPECT_EQ(keyless.state(), RobotState::kDisarmed);
  keyless.send(keyless.emergency_stop());
  keyless.tick();
  EXPECT_EQ(keyless.state(), RobotState::kFault) << "the emergency stop needs no key";
}

TEST(Command, OfAnEarlierStartIsRefusedFault10) {
  TestRobot robot = ready_robot();
  const CanFrame arm = robot.command(CommandOp::kArm);
  EXPECT_EQ(result_of(robot, arm), RequestResult::kDone);
  TestRobot again = ready_robot();
  again.robot = Robot(kBoard, Parameters{}, credentials_of(test_key(), kFirstBootEpoch + 1));
  again.run(600);
  EXPECT_EQ(result_of(again, arm), RequestResult::kBadMac);
  EXPECT_EQ(again.state(), RobotState::kDisarmed);
}

TEST(Command, OfAnotherRobotIsRefusedFault11) {
  CommandKey key = test_key();
  key.robot_id = 1 + kMaxNode;  // of the same node, so that the robot looks at it
  TestRobot robot = ready_robot();
  robot.signer = CommandSigner(key);
  message::Heartbeat heartbeat{};
  heartbeat.boot_epoch = kFirstBootEpoch;
  robot.signer.handle_frame(frame_of(heartbeat));
  EXPECT_EQ(result_of(robot, CommandOp::kArm), RequestResult::kBadMac);
  CanFrame elsewhere = ready_robot().command(CommandOp::kArm);
  elsewhere.id = 0x120;  // node 2
  robot.send(elsewhere);
  EXPECT_FALSE(robot.answer().has_value());
}

TEST(Command, AFloodOfWrongMacsLocksOutAndTheEmergencyStopStillWorksFault9) {
  Parameters parameters;
  parameters.escape_attempts() = 0;  // its IMU stands still while the tracks turn
  TestRobot robot = ready_robot(parameters);
  robot.send(robot.command(CommandOp::kArm));
  robot.run(4);
  robot.send(robot.command(CommandOp::kRun));
  robot.run(4);
  ASSERT_EQ(robot.state(), RobotState::kRunning);
  const CanFrame good = robot.command(CommandOp::kStop);
  CanFrame wrong = good;
  for (int tick = 0; tick < 3000; ++tick) {
    wrong.data[7] = static_cast<uint8_t>(tick);
    if (wrong.data[7] != good.data[7]) robot.send(wrong);
    robot.tick();
  }
  EXPECT_LE(robot.robot.gate().refused(), 2 * CommandGate::kMaxBadMacs);
  EXPECT_EQ(robot.state(), RobotState::kRunning) << "the ground heartbeat was not harmed";
  robot.queue.clear();
  robot.run(2);
  EXPECT_EQ(result_of(robot, CommandOp::kStop), RequestResult::kLockedOut);
  robot.send(robot.emergency_stop());
  robot.tick();
  EXPECT_EQ(robot.state(), RobotState::kFault);
  robot.run(CommandGate::kLockoutTicks);
  EXPECT_EQ(result_of(robot, CommandOp::kClear), RequestResult::kDone);
}

TEST(Command, ArmingWithoutALiveLinkIsRefused) {
  TestRobot robot;
  robot.heartbeats = false;
  robot.run(600);
  EXPECT_EQ(result_of(robot, CommandOp::kArm), RequestResult::kNoLink);
  EXPECT_EQ(robot.state(), RobotState::kDisarmed);
  robot.heartbeats = true;
  robot.run(40);
  EXPECT_EQ(result_of(robot, CommandOp::kArm), RequestResult::kDone);
}

TEST(Command, ALostLinkStopsThenDisarmsAndOnlyAFreshCommandArmsAgain) {
  TestRobot robot = ready_robot();
  const CanFrame arm = robot.command(CommandOp::kArm);
  const CanFrame run = robot.command(CommandOp::kRun);
  ASSERT_EQ(result_of(robot, arm), RequestResult::kDone);
  ASSERT_EQ(result_of(robot, run), RequestResult::kDone);
  while (robot.ticks % 20 != 1) robot.tick();
  robot.heartbeats = false;
  robot.run(60);
  EXPECT_EQ(robot.state(), RobotState::kStopped);
  EXPECT_EQ(result_of(robot, CommandOp::kRun), RequestResult::kNoLink);
  robot.run(100);
  EXPECT_EQ(robot.state(), RobotState::kDisarmed);
  robot.heartbeats = true;
  robot.run(100);
  for (const CanFrame& old : {arm, run}) {
    robot.send(old);
    robot.run(10);
    EXPECT_EQ(robot.state(), RobotState::kDisarmed) << "a recorded command";
  }
  EXPECT_EQ(result_of(robot, CommandOp::kArm), RequestResult::kDone);
}

TEST(Command, DriveIsForTheAlgorithmDriveWhileItRuns) {
  TestRobot walking = ready_robot();
  ASSERT_EQ(result_of(walking, CommandOp::kArm), RequestResult::kDone);
  ASSERT_EQ(result_of(walking, CommandOp::kRun), RequestResult::kDone);
  EXPECT_EQ(result_of(walking, walking.command(CommandOp::kDrive, {100, 0})),
            RequestResult::kWrongState);
  Parameters parameters;
  parameters.algorithm() = static_cast<int16_t>(LevelingAlgorithm::kDrive);
  TestRobot driven = ready_robot(parameters);
  EXPECT_EQ(result_of(driven, driven.command(CommandOp::kDrive, {100, 0})),
            RequestResult::kWrongState);
}

// ---- parameters

CanFrame stage(uint16_t index, int32_t value) {
  uint8_t counter = 3;
  return TestRobot::protect(frame_of(message::ParamStage{index, value}), counter);
}

/// The next frame of an id that the robot sends, within so many ticks.
std::optional<CanFrame> next_frame(TestRobot& robot, uint16_t id, int ticks) {
  for (int i = 0; i < ticks; ++i) {
    robot.tick();
    SlcanParser parser;
    CanFrame frame{};
    for (uint8_t at = 0; at < robot.output.radio_out_count; ++at) {
      if (parser.feed(robot.output.radio_out[at], frame) && frame.id == id) return frame;
    }
  }
  return std::nullopt;
}

int rejected_frames(TestRobot& robot) {
  const std::optional<CanFrame> link = next_frame(robot, kIdLink, 200);
  return link ? message::Link::unpack(link->data).frames_rejected : -1;
}

/// The argument that commits what stage() staged.
uint32_t commitment(uint8_t index, int32_t value) {
  uint8_t bytes[4];
  put_u16(bytes, index);
  put_u16(bytes + 2, static_cast<uint16_t>(value));
  return index | static_cast<uint32_t>(crc16_ccitt(bytes, sizeof bytes)) << 8;
}

RequestResult commit(TestRobot& robot, uint8_t index, int32_t value) {
  robot.send(stage(index, value));
  return result_of(robot, robot.signer.sign(CommandOp::kParameterCommit, commitment(index, value)));
}

std::optional<message::ParamValue> read(TestRobot& robot, uint8_t index) {
  robot.send(robot.signer.sign(CommandOp::kParameterRead, index));
  const std::optional<CanFrame> value = next_frame(robot, kIdParamValue, 10);
  return value ? std::optional(message::ParamValue::unpack(value->data)) : std::nullopt;
}

TEST(RadioParameters, AreReadByIndex) {
  Parameters parameters;
  parameters.climb_threshold() = 777;
  TestRobot robot = ready_robot(parameters);
  for (uint8_t index = 0; index < Parameters::kCount; ++index) {
    const auto value = read(robot, index);
    ASSERT_TRUE(value.has_value()) << static_cast<int>(index);
    EXPECT_EQ(value->index, index);
    EXPECT_EQ(value->value, parameters.values[index]);
  }
  EXPECT_FALSE(read(robot, Parameters::kCount).has_value());
  robot.send(robot.signer.sign(CommandOp::kParameterRead, Parameters::kCount));
  const auto answer = robot.answer();
  ASSERT_TRUE(answer.has_value());
  EXPECT_EQ(answer->result, static_cast<uint8_t>(RequestResult::kBadArgument));
  EXPECT_EQ(answer->detail, Parameters::kCount) << "says how many there are";
}

TEST(RadioParameters, ACommittedOneHoldsAtOnceAndIsStoredOnce) {
  TestRobot robot = ready_robot();
  robot.send(stage(kAlgorithm, static_cast<int>(LevelingAlgorithm::kDrive)));
  robot.send(
      robot.signer.sign(CommandOp::kParameterCommit,
                        commitment(kAlgorithm, static_cast<int>(LevelingAlgorithm::kDrive))));
  int stored = 0;
  for (int i = 0; i < 20; ++i) {
    robot.tick();
    if (robot.output.store_parameter == 0) continue;
    ++stored;
    EXPECT_EQ(robot.output.store_parameter, kAlgorithm + 1);
    EXPECT_EQ(robot.output.store_value, static_cast<int>(LevelingAlgorithm::kDrive));
  }
  EXPECT_EQ(stored, 1);
  EXPECT_EQ(robot.robot.parameters().algorithm(), static_cast<int>(LevelingAlgorithm::kDrive));
  EXPECT_EQ(robot.robot.leveling().algorithm(), LevelingAlgorithm::kDrive);
}

TEST(RadioParameters, AStricterTiltLimitIsHeededAtOnce) {
  TestRobot robot = ready_robot();
  EXPECT_EQ(commit(robot, kTiltLimit, 1000), RequestResult::kDone);
  robot.sample.imu.accel()[0] = 1400;  // 20 degrees nose up
  robot.sample.imu.accel()[2] = 3850;
  robot.run(100);
  EXPECT_EQ(result_of(robot, CommandOp::kArm), RequestResult::kFaultPresent);
}

// As an image without this algorithm finds them in its EEPROM.
TEST(RadioParameters, AChangeThatMakesThemValidLetsTheRobotBeArmed) {
  Parameters parameters;
  parameters.algorithm() = message::kLevelingAlgorithmMax + 1;
  for (const bool intact : {true, false}) {
    TestRobot robot(parameters);
    if (!intact) {
      robot.robot = Robot(kBoard, parameters, credentials_of(test_key()), false);
    }
    robot.run(600);
    EXPECT_EQ(result_of(robot, CommandOp::kArm), RequestResult::kFaultPresent);
    EXPECT_EQ(robot.robot.supervisor().reported_faults(), Fault::kParameters);
    EXPECT_EQ(commit(robot, kSpeedKp, 30), RequestResult::kBadArgument) << "still not valid";
    EXPECT_EQ(commit(robot, kAlgorithm, static_cast<int>(LevelingAlgorithm::kDrive)),
              RequestResult::kDone);
    robot.tick();
    EXPECT_EQ(result_of(robot, CommandOp::kArm),
              intact ? RequestResult::kDone : RequestResult::kFaultPresent)
        << "lost ones stay lost";
  }
}

// A frame whose CRC is right and whose size is not that of its message is not taken for one.
TEST(RadioParameters, AFrameOfAnotherSizeIsRejected) {
  TestRobot robot = ready_robot();
  robot.send(stage(kSpeedKp, 31));
  const auto rejected = [&](CanFrame frame) {
    const int before = rejected_frames(robot);
    for (uint8_t size = 3; size <= 8; ++size) {
      CanFrame other = frame;
      other.size = size;
      if (size == frame.size) continue;
      uint8_t counter = 3;
      robot.send(TestRobot::protect(other, counter));
      robot.run(3);
    }
    return rejected_frames(robot) - before;
  };
  EXPECT_EQ(rejected(stage(kSpeedKp, 40)), 5);
  EXPECT_EQ(rejected(frame_of(message::GroundHeartbeat{1000})), 5);
  EXPECT_EQ(rejected(frame_of(message::EmergencyStop{})), 5);
  EXPECT_NE(robot.state(), RobotState::kFault) << "no emergency stop among them";
  EXPECT_EQ(
      result_of(robot, robot.signer.sign(CommandOp::kParameterCommit, commitment(kSpeedKp, 31))),
      RequestResult::kDone)
      << "what was staged is whole";
}

TEST(RadioParameters, WhatIsNotStagedOrOutOfRangeIsRefused) {
  TestRobot robot = ready_robot();
  // Nothing staged; another value; another index; more than 16 bits; out of range; no such index.
  EXPECT_EQ(
      result_of(robot, robot.signer.sign(CommandOp::kParameterCommit, commitment(kSpeedKp, 30))),
      RequestResult::kBadArgument);
  robot.send(stage(kSpeedKp, 31));
  EXPECT_EQ(
      result_of(robot, robot.signer.sign(CommandOp::kParameterCommit, commitment(kSpeedKp, 30))),
      RequestResult::kBadArgument);
  robot.send(stage(kTiltLimit, 30));
  EXPECT_EQ(
      result_of(robot, robot.signer.sign(CommandOp::kParameterCommit, commitment(kSpeedKp, 30))),
      RequestResult::kBadArgument);
  EXPECT_EQ(commit(robot, kSpeedKp, 65536 + 30), RequestResult::kBadArgument);
  EXPECT_EQ(commit(robot, kSpeedKp, 321), RequestResult::kBadArgument);
  EXPECT_EQ(commit(robot, Parameters::kCount, 1), RequestResult::kBadArgument);
  EXPECT_EQ(robot.robot.parameters().speed_kp(), Parameters{}.speed_kp());
  EXPECT_EQ(commit(robot, kSpeedKp, 30), RequestResult::kDone);
  EXPECT_EQ(robot.robot.parameters().speed_kp(), 30);
}

TEST(RadioParameters, OneAtATime) {
  TestRobot robot = ready_robot();
  EXPECT_EQ(commit(robot, kSpeedKp, 30), RequestResult::kDone);
  EXPECT_EQ(commit(robot, kSpeedKp, 31), RequestResult::kBusy);
  robot.run(240);
  EXPECT_EQ(commit(robot, kSpeedKp, 31), RequestResult::kDone);
  EXPECT_EQ(robot.robot.parameters().speed_kp(), 31);
}

TEST(RadioParameters, AnArmedRobotTakesTheLiveOnesAlone) {
  TestRobot robot = ready_robot();
  ASSERT_EQ(result_of(robot, CommandOp::kArm), RequestResult::kDone);
  int live = 0;
  for (uint8_t number = 0; number < Parameters::kCount; ++number) {
    const ParameterInfo& info = kParameterTable[number];
    live += changes_while_running(number) ? 1 : 0;
    const RequestResult expected =
        changes_while_running(number) ? RequestResult::kDone : RequestResult::kWrongState;
    EXPECT_EQ(commit(robot, number, info.default_value), expected) << info.name;
    robot.run(240);
  }
  EXPECT_EQ(robot.state(), RobotState::kArmed);
  EXPECT_EQ(live, 21);
  EXPECT_FALSE(changes_while_running(kAlgorithm));
}

// Each part of the core that keeps parameters takes the new ones, in the next tick.
TEST(RadioParameters, ARunningRobotDrivesByThem) {
  Parameters walks;
  walks.algorithm() = static_cast<int16_t>(LevelingAlgorithm::kHillSensing);
  walks.walk_leg_max() = walks.walk_leg_min();
  // What carries this robot neither turns nor pushes it.
  walks.walk_yaw_rate_max() = 0;
  walks.escape_attempts() = 0;
  TestRobot robot = ready_robot(walks);
  ASSERT_EQ(result_of(robot, CommandOp::kArm), RequestResult::kDone);
  ASSERT_EQ(result_of(robot, CommandOp::kRun), RequestResult::kDone);
  const auto asked = [&] {
    const TrackSpeeds& targets = robot.robot.drive().targets();
    return (targets.left + targets.right) / 2;
  };
  const auto set = [&](Parameters::Number number, int16_t value) {
    EXPECT_EQ(commit(robot, number, value), RequestResult::kDone);
  };
  set(Parameters::k_walk_speed_max, 90);
  robot.run(240);
  set(Parameters::k_walk_speed_min, 90);
  robot.run(240);
  EXPECT_NEAR(asked(), 90, 2) << "the legs of the walk";
  set(Parameters::k_accel_limit, 50);
  robot.run(240);
  set(Parameters::k_walk_speed_max, 250);
  robot.run(240);
  set(Parameters::k_walk_speed_min, 250);
  int before = asked();
  const int slow = before;
  for (int i = 0; i < 400; ++i) {
    robot.run(1);
    EXPECT_LE(std::abs(asked() - before), 1) << "the drive's acceleration";
    before = asked();
  }
  EXPECT_GT(asked(), 240) << "from " << slow;
  EXPECT_EQ(robot.state(), RobotState::kRunning);
}

TEST(RadioParameters, NoOtherStagedValueFitsACommit) {
  // What is staged is not signed: the CRC16 in the signed command must leave one value of 16 bits.
  const uint32_t good = commitment(kSpeedKp, 30);
  for (int value = INT16_MIN; value <= INT16_MAX; ++value) {
    ASSERT_EQ(commitment(kSpeedKp, value) == good, value == 30) << value;
  }
}

// ---- odometry and fence

/// Carries the robot over the floor, its tracks turning, so slowly that no slip is sought.
void push(TestRobot& robot, int way_mm) {
  for (int i = 0; i * 0.1885 < way_mm; ++i) {
    if (i % 3 == 0) {
      robot.sample.encoder_left = static_cast<uint16_t>(robot.sample.encoder_left + 1);
      robot.sample.encoder_right = static_cast<uint16_t>(robot.sample.encoder_right + 1);
    }
    robot.tick();
  }
}

TEST(Run, BeginsAtItsOwnOrigin) {
  TestRobot robot = ready_robot();
  // Carried over the floor, tracks turning, before it is armed.
  push(robot, 600);
  robot.run(50);  // set down: tracks that something else turns keep it from being armed
  EXPECT_GT(std::abs(robot.robot.position().mm(kX)) + std::abs(robot.robot.position().mm(kY)), 500);
  ASSERT_EQ(result_of(robot, CommandOp::kArm), RequestResult::kDone);
  robot.send(robot.command(CommandOp::kRun));
  while (robot.state() != RobotState::kRunning) robot.tick();
  EXPECT_LE(std::abs(robot.robot.position().mm(kX)), 1);
  EXPECT_LE(std::abs(robot.robot.position().mm(kY)), 1);
}

TEST(Run, ThatGoesOnAfterAStopKeepsItsOrigin) {
  Parameters parameters;
  parameters.algorithm() = static_cast<int16_t>(LevelingAlgorithm::kDrive);
  TestRobot robot(parameters);
  robot.start();
  robot.send(robot.command(CommandOp::kDrive, {30, 0}));  // no slip is sought below 35 mm/s
  robot.run(1500);
  const auto way = [&robot] {
    return std::abs(robot.robot.position().mm(kX)) + std::abs(robot.robot.position().mm(kY));
  };
  ASSERT_GT(way(), 300);
  ASSERT_EQ(result_of(robot, CommandOp::kStop), RequestResult::kDone);
  robot.run(50);
  ASSERT_EQ(result_of(robot, CommandOp::kRun), RequestResult::kDone);
  EXPECT_GT(way(), 300) << "the same run";
  ASSERT_EQ(result_of(robot, CommandOp::kDisarm), RequestResult::kDone);
  ASSERT_EQ(result_of(robot, CommandOp::kArm), RequestResult::kDone);
  ASSERT_EQ(result_of(robot, CommandOp::kRun), RequestResult::kDone);
  EXPECT_LE(way(), 2) << "a new one";
}

TEST(Run, TheFenceLiesRoundThePlaceWhereItBegan) {
  Parameters parameters;
  parameters.site_radius() = 1000;
  TestRobot robot = ready_robot(parameters);
  push(robot, 1200);
  robot.run(50);
  ASSERT_GT(std::hypot(robot.robot.position().mm(kX), robot.robot.position().mm(kY)), 1000);
  ASSERT_EQ(result_of(robot, CommandOp::kArm), RequestResult::kDone);
  ASSERT_EQ(result_of(robot, CommandOp::kRun), RequestResult::kDone);
  robot.run(50);
  EXPECT_NE(robot.robot.leveling().state(), LevelingState::kReturn);
}

// Where the first one contradicts what the robot believes, it doubts both, and the second says
// where it was put.
TEST(PositionFix, TellsTheRobotWhereItIs) {
  Parameters parameters;
  parameters.fix_sigma() = 30;
  TestRobot robot = ready_robot(parameters);
  const DriveArgument far{120, -85};
  ASSERT_EQ(result_of(robot, robot.command(CommandOp::kPositionFix, far)), RequestResult::kDone);
  EXPECT_EQ(robot.robot.position().mm(kX), 0);
  ASSERT_EQ(result_of(robot, robot.command(CommandOp::kPositionFix, far)), RequestResult::kDone);
  EXPECT_NEAR(robot.robot.position().mm(kX), 1200, 20);
  EXPECT_NEAR(robot.robot.position().mm(kY), -850, 15);
  // The next one at rest is as good as that.
  ASSERT_EQ(result_of(robot, robot.command(CommandOp::kPositionFix, {130, -85})),
            RequestResult::kDone);
  EXPECT_NEAR(robot.robot.position().mm(kX), 1242, 10);
  for (int i = 0; i < 6000; ++i) {  // until it does not know that well any more
    robot.sample.encoder_left = static_cast<uint16_t>(robot.sample.encoder_left + 5);
    robot.sample.encoder_right = static_cast<uint16_t>(robot.sample.encoder_right - 5);
    robot.tick();
  }
  robot.run(50);
  ASSERT_EQ(result_of(robot, robot.command(CommandOp::kPositionFix, {20, 35})),
            RequestResult::kDone);
  EXPECT_NEAR(robot.robot.position().mm(kX), 200, 50);
  EXPECT_NEAR(robot.robot.position().mm(kY), 350, 50);
}

// The site is that of the fixes: a run does not begin at an origin of its own.
TEST(PositionFix, ARunBeginsWhereTheFixesSay) {
  Parameters parameters;
  parameters.fix_sigma() = 8;
  parameters.site_radius() = 500;
  TestRobot robot = ready_robot(parameters);
  for (int i = 0; i < 3000; ++i) {
    robot.sample.encoder_left = static_cast<uint16_t>(robot.sample.encoder_left + 5);
    robot.sample.encoder_right = static_cast<uint16_t>(robot.sample.encoder_right - 5);
    robot.tick();
  }
  robot.run(50);
  for (int i = 0; i < 2; ++i) {
    ASSERT_EQ(result_of(robot, robot.command(CommandOp::kPositionFix, {100, 0})),
              RequestResult::kDone);
  }
  ASSERT_EQ(result_of(robot, CommandOp::kArm), RequestResult::kDone);
  ASSERT_EQ(result_of(robot, CommandOp::kRun), RequestResult::kDone);
  robot.run(5);
  EXPECT_NEAR(robot.robot.position().mm(kX), 1000, 30);
  EXPECT_LT(robot.robot.motion().speed_mm_per_s, 0) << "outside the site: it backs in";
}

TEST(Lost, StopsWithTheFault) {
  Parameters parameters;
  parameters.lost_sigma() = 20;
  TestRobot robot(parameters);
  robot.start();
  ASSERT_EQ(robot.state(), RobotState::kRunning);
  for (int i = 0; i < 3000 && robot.state() == RobotState::kRunning; ++i) robot.tick();
  EXPECT_EQ(robot.state(), RobotState::kFault);
  EXPECT_EQ(robot.robot.supervisor().faults(), Fault::kLost);
}

/// A robot in a walled site of 0.8 m by 0.8 m that has lost its place and drives at a wall. It has
/// walked too slowly for its slip watch, whose senses are not simulated here.
struct WallSeeker : TestRobot {
  static constexpr int16_t kSite_mm = 400;

  WallSeeker() : TestRobot(parameters()) {
    start();
    for (int i = 0; i < 1000 && !seeks(); ++i) tick();
    run(5);
    EXPECT_TRUE(seeks());
    EXPECT_FALSE(robot.slip_watch().stuck());
  }
  static Parameters parameters() {
    Parameters parameters;
    parameters.site_x() = kSite_mm;
    parameters.site_y() = kSite_mm;
    parameters.walk_speed_min() = 30;
    parameters.walk_speed_max() = 30;
    parameters.walk_yaw_rate_max() = 0;
    parameters.position_noise() = 1000;
    parameters.lost_sigma() = 28;
    parameters.lost_action() = static_cast<int16_t>(LostAction::kSeekWall);
    return parameters;
  }
  bool seeks() const { return robot.leveling().state() == LevelingState::kSeekWall; }
  /// Raises the nose by so much within a quarter of a second.
  void raise_nose(double degrees) {
    constexpr int kTicks = 25;
    const double step = degrees / kTicks;
    sample.imu.gyro()[1] = static_cast<int16_t>(std::lround(-step * 100.0 / 0.07));
    for (int i = 1; i <= kTicks; ++i) {
      const double angle = i * step * std::numbers::pi / 180.0;
      sample.imu.accel()[0] = static_cast<int16_t>(std::lround(4098 * std::sin(angle)));
      sample.imu.accel()[2] = static_cast<int16_t>(std::lround(4098 * std::cos(angle)));
      tick();
    }
    sample.imu.gyro()[1] = 0;
  }
};

TEST(WallSearch, ARobotThatClimbsTheWallItSeeksTakesItForFoundAndBacksOff) {
  for (const double pitch : {25.0, 35.0, -35.0}) {
    WallSeeker robot;
    const int speed = robot.robot.motion().speed_mm_per_s;
    robot.raise_nose(pitch);
    const bool steep = std::abs(pitch) > 30.0;
    EXPECT_EQ(robot.seeks(), !steep) << pitch;
    if (!steep) continue;
    EXPECT_EQ(robot.robot.leveling().state(), LevelingState::kEscape);
    EXPECT_LT(robot.robot.motion().speed_mm_per_s * speed, 0) << "the way it came";
    const int reach =
        std::max(std::abs(robot.robot.position().mm(kX)), std::abs(robot.robot.position().mm(kY)));
    EXPECT_NEAR(reach, WallSeeker::kSite_mm - kBoard.hull_reach_mm, 30) << "it stands at a wall";
  }
}

// Its own escape from a hole is no collision: it would believe itself at the wall behind it.
TEST(WallSearch, WhatStopsAnEscapeIsNoWall) {
  WallSeeker robot;
  for (const double degrees : {35.0, -35.0, 35.0}) robot.raise_nose(degrees);
  ASSERT_EQ(robot.robot.leveling().state(), LevelingState::kEscape);
  Place place{};
  robot.robot.position().get(place);
  EXPECT_LT(std::max(place.sigma[kX], place.sigma[kY]), 128) << "a wall that cannot be makes doubt";
}

// Dead reckoning that runs on beyond the walls would take minutes of driving back to be right
// again.
TEST(WallSearch, NoRobotBelievesItselfBeyondAWall) {
  WallSeeker robot;
  for (int i = 0; i < 2000; ++i) {
    robot.sample.encoder_left = static_cast<uint16_t>(robot.sample.encoder_left + 2);
    robot.sample.encoder_right = static_cast<uint16_t>(robot.sample.encoder_right + 2);
    robot.tick();
  }
  const PositionEstimate& position = robot.robot.position();
  EXPECT_NEAR(std::max(std::abs(position.mm(kX)), std::abs(position.mm(kY))), WallSeeker::kSite_mm,
              8);
}

}  // namespace
}  // namespace screed
