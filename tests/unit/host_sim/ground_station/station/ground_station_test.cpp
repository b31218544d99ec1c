// The simulated ground station, and its camera's fixes.
#include <gtest/gtest.h>
#include <regex.h>  // POSIX: gcc 12 warns of std::regex under the sanitizers
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "firmware/protocol/e2e.h"
#include "host_sim/ground_station/station/ground_station.h"
#include "tests/unit/test_robot.h"

namespace screed {

namespace {

// The simulated ground station: what it sends when, and the log that others must be able to read.

std::vector<uint8_t> line_of(CanFrame frame, uint8_t counter = 0) {
  e2e_protect(frame.id, counter, frame.data, frame.size);
  std::vector<uint8_t> line(kSlcanLineMax);
  line.resize(slcan_encode(frame, line.data()));
  return line;
}

std::vector<uint8_t> robot_heartbeat(RobotState state, uint16_t faults = 0) {
  message::Heartbeat heartbeat{};
  heartbeat.state = static_cast<uint8_t>(state);
  heartbeat.faults = faults;
  return line_of(frame_of(heartbeat));
}

/// The frames of a second's transmissions, by tick.
struct Sent {
  uint64_t tick;
  CanFrame frame;
};
std::vector<Sent> transmit(GroundStation& ground, uint64_t ticks) {
  std::vector<Sent> sent;
  SlcanParser parser;
  for (uint64_t tick = 0; tick < ticks; ++tick) {
    CanFrame frame{};
    for (const uint8_t byte : ground.transmit(tick * 10000)) {
      if (parser.feed(byte, frame)) {
        EXPECT_TRUE(frame.id == kIdCommand || e2e_check(frame.id, frame.data, frame.size));
        sent.push_back({tick, frame});
      }
    }
  }
  EXPECT_EQ(parser.rejected(), 0);
  return sent;
}

std::vector<int> commands(GroundStation& ground, uint64_t ticks = 100) {
  std::vector<int> ops;
  for (const Sent& sent : transmit(ground, ticks)) {
    if (sent.frame.id == kIdCommand) ops.push_back(sent.frame.data[0]);
  }
  return ops;
}

TEST(GroundStation, HeartbeatsFiveTimesASecondWithTimeAndRisingCounter) {
  GroundStation ground(false, std::nullopt, nullptr);
  const std::vector<Sent> sent = transmit(ground, 1000);
  ASSERT_EQ(sent.size(), 50U);
  for (size_t i = 0; i < sent.size(); ++i) {
    EXPECT_EQ(sent[i].frame.id, kIdGroundHeartbeat);
    EXPECT_EQ(sent[i].tick, i * 20);
    EXPECT_EQ(sent[i].frame.data[1] & 0x0F, static_cast<int>(i % 16));
    EXPECT_EQ(get_u16(sent[i].frame.data + 2), i * 200);
  }
}

TEST(GroundStation, SaysNothingElseBeforeItHearsTheRobot) {
  GroundStation ground(true, DriveCommand{}, nullptr);
  EXPECT_TRUE(commands(ground).empty());
  EXPECT_FALSE(ground.report().heard);
}

TEST(GroundStation, ArmsThenRunsThenDrives) {
  GroundStation ground(true, DriveCommand{0.1, -45.0}, nullptr);
  ground.receive(0, robot_heartbeat(RobotState::kDisarmed));
  EXPECT_EQ(commands(ground),
            std::vector<int>(
                4, static_cast<int>(CommandOp::kArm)));  // four times a second until it is done
  ground.receive(0, robot_heartbeat(RobotState::kArmed));
  EXPECT_EQ(commands(ground), std::vector<int>(4, static_cast<int>(CommandOp::kRun)));
  ground.receive(0, robot_heartbeat(RobotState::kRunning));
  const std::vector<Sent> sent = transmit(ground, 100);
  int drives = 0;
  for (const Sent& one : sent) {
    if (one.frame.id != kIdCommand) continue;
    ++drives;
    EXPECT_EQ(one.frame.data[0], static_cast<uint8_t>(CommandOp::kDrive));
    const DriveArgument argument = get_drive_argument(one.frame.data + 1);
    EXPECT_EQ(argument.speed_mm_per_s, 100);
    EXPECT_EQ(argument.turn_ddeg_per_s, -450);
  }
  EXPECT_EQ(drives, 4);
}

TEST(GroundStation, WithoutADriveOrderARunningRobotIsLeftAlone) {
  GroundStation ground(true, std::nullopt, nullptr);
  ground.receive(0, robot_heartbeat(RobotState::kRunning));
  EXPECT_TRUE(commands(ground).empty());
}

TEST(GroundStation, DoesNotStartARobotThatHasBeenRunning) {
  GroundStation ground(true, std::nullopt, nullptr);
  ground.receive(0, robot_heartbeat(RobotState::kRunning));
  for (const RobotState state : {RobotState::kDisarmed, RobotState::kStopped, RobotState::kFault}) {
    ground.receive(0, robot_heartbeat(state, 1));
    EXPECT_TRUE(commands(ground).empty());
  }
  EXPECT_EQ(ground.report().faults, 1);
}

TEST(GroundStation, DoesNotArmUnlessTold) {
  GroundStation ground(false, DriveCommand{}, nullptr);
  for (const RobotState state : {RobotState::kDisarmed, RobotState::kArmed}) {
    ground.receive(0, robot_heartbeat(state));
    EXPECT_TRUE(commands(ground).empty());
  }
}

TEST(GroundStation, NoTickCarriesMoreThanOnePacketOfFourLines) {
  GroundStation ground(true, DriveCommand{}, nullptr);
  ground.receive(0, robot_heartbeat(RobotState::kRunning));
  for (uint64_t tick = 0; tick < 1000; ++tick)
    EXPECT_LE(ground.transmit(tick * 10000).size(), kSlcanLineMax);
}

/// The groups of a whole-line match, none when it does not match.
std::vector<std::string> groups(const char* pattern, const std::string& text) {
  regex_t compiled;
  EXPECT_EQ(regcomp(&compiled, pattern, REG_EXTENDED), 0);
  regmatch_t match[8];
  std::vector<std::string> all;
  if (regexec(&compiled, text.c_str(), 8, match, 0) == 0) {
    for (size_t i = 1; i <= compiled.re_nsub; ++i) {
      const auto begin = static_cast<size_t>(match[i].rm_so);
      all.push_back(text.substr(begin, static_cast<size_t>(match[i].rm_eo) - begin));
    }
  }
  regfree(&compiled);
  return all;
}

TEST(GroundStation, LogIsCandumpText) {
  std::ostringstream log;
  GroundStation ground(false, std::nullopt, &log);
  ground.receive(1234567890123, robot_heartbeat(RobotState::kArmed));
  ground.receive(10000, line_of({kIdBaro, 8, {}}));
  // candump -L: (seconds.microseconds) interface id#data, as in "(1436509052.249713) vcan0
  // 044#2A366C2BBA".
  const char* const line =
      "^\\(([0-9]{10})\\.([0-9]{6})\\) [A-Za-z][A-Za-z0-9]{0,14} ([0-9A-F]{3})#([0-9A-F]{0,16})$";
  ASSERT_EQ(groups(line, "(1436509052.249713) vcan0 044#2A366C2BBA").size(), 4U);
  std::istringstream lines(log.str());
  std::string text;
  ASSERT_TRUE(std::getline(lines, text));
  std::vector<std::string> parts = groups(line, text);
  ASSERT_EQ(parts.size(), 4U) << text;
  EXPECT_EQ(parts[0], "0001234567");
  EXPECT_EQ(parts[1], "890123");
  EXPECT_EQ(parts[2], "010");
  EXPECT_EQ(parts[3].size(), 16U);
  ASSERT_TRUE(std::getline(lines, text));
  parts = groups(line, text);
  ASSERT_EQ(parts.size(), 4U) << text;
  EXPECT_EQ(parts[0], "0000000000");
  EXPECT_EQ(parts[1], "010000");
  EXPECT_EQ(parts[2], "313");
  EXPECT_EQ(parts[3].size(), 16U);
  EXPECT_FALSE(std::getline(lines, text));
}

TEST(GroundStation, DamagedFramesAreCountedAndNotLogged) {
  std::ostringstream log;
  GroundStation ground(true, std::nullopt, &log);
  std::vector<uint8_t> bytes = robot_heartbeat(RobotState::kDisarmed);
  bytes[10] = bytes[10] == '0' ? '1' : '0';
  ground.receive(0, bytes);
  EXPECT_EQ(ground.rejected_frames(), 1U);
  EXPECT_EQ(ground.frames(), 0U);
  EXPECT_FALSE(ground.report().heard);
  EXPECT_TRUE(log.str().empty());
}

TEST(GroundStation, SetsParametersFromTheirTimeOnOneByOne) {
  GroundStation ground(false, std::nullopt, nullptr);
  ground.change({1.0, {{Parameters::k_climb_speed, 90}, {Parameters::k_stall_time, 400}}});
  ground.receive(0, robot_heartbeat(RobotState::kRunning));
  EXPECT_TRUE(commands(ground, 100).empty());
  const auto next = [&ground] {
    const std::vector<Sent> sent = transmit(ground, 100);
    std::vector<message::ParamStage> staged;
    for (size_t i = 0; i < sent.size(); ++i) {
      if (sent[i].frame.id != kIdParamStage) continue;
      staged.push_back(message::ParamStage::unpack(sent[i].frame.data));
      const Sent& commit = sent.at(i + 1);
      EXPECT_EQ(commit.tick, sent[i].tick);
      EXPECT_EQ(commit.frame.data[0], static_cast<uint8_t>(CommandOp::kParameterCommit));
      EXPECT_EQ(commit.frame.data[1], staged.back().index);
    }
    EXPECT_EQ(staged.size(), 2U);
    return staged.at(1);
  };
  const auto answer = [&ground](RequestResult result, uint8_t freshness) {
    ground.receive(
        0, line_of(frame_of(message::CommandAck{static_cast<uint8_t>(CommandOp::kParameterCommit),
                                                freshness, static_cast<uint8_t>(result), 0})));
  };
  EXPECT_EQ(next().index, Parameters::k_climb_speed);
  EXPECT_EQ(next().value, 90);  // again, without an answer
  answer(RequestResult::kBusy, 4);
  EXPECT_EQ(next().index, Parameters::k_climb_speed);
  answer(RequestResult::kBadArgument, 6);  // beside what the other one still is
  EXPECT_EQ(next().index, Parameters::k_stall_time);
  answer(RequestResult::kDone, 7);  // of an earlier command
  EXPECT_EQ(next().value, 400);
  answer(RequestResult::kDone, 10);
  EXPECT_EQ(next().index, Parameters::k_climb_speed);
  answer(RequestResult::kDone, 12);
  EXPECT_TRUE(commands(ground, 200).empty());
}

TEST(GroundStation, ARunningRobotTakesTheParametersThatAreSetLater) {
  GroundStation ground(true, DriveCommand{0.1, 0.0}, nullptr);
  // The first is above what the second still is.
  ground.change({6.0, {{Parameters::k_walk_speed_min, 200}, {Parameters::k_walk_speed_max, 220}}});
  Parameters parameters;
  parameters.algorithm() = static_cast<int16_t>(LevelingAlgorithm::kDrive);
  TestRobot robot(parameters);
  robot.heartbeats = false;
  const auto live = [&](uint64_t first, uint64_t end) {
    for (uint64_t tick = first; tick < end; ++tick) {
      const std::vector<uint8_t> up = ground.transmit(tick * 10000);
      robot.queue.insert(robot.queue.end(), up.begin(), up.end());
      robot.tick();
      ground.receive(tick * 10000, {robot.output.radio_out, robot.output.radio_out_count});
    }
  };
  live(0, 600);
  EXPECT_EQ(robot.robot.parameters().walk_speed_max(), 160);
  live(600, 1400);
  EXPECT_EQ(robot.robot.supervisor().state(), RobotState::kRunning);
  EXPECT_EQ(robot.robot.parameters().walk_speed_min(), 200);
  EXPECT_EQ(robot.robot.parameters().walk_speed_max(), 220);
}

TEST(GroundStation, BringsARealRobotToRun) {
  GroundStation ground(true, DriveCommand{0.1, 0.0}, nullptr);
  Parameters parameters;
  parameters.algorithm() = static_cast<int16_t>(LevelingAlgorithm::kDrive);
  TestRobot robot(parameters);
  robot.heartbeats = false;
  for (uint64_t tick = 0; tick < 800; ++tick) {
    const std::vector<uint8_t> up = ground.transmit(tick * 10000);
    robot.queue.insert(robot.queue.end(), up.begin(), up.end());
    robot.tick();
    ground.receive(tick * 10000, {robot.output.radio_out, robot.output.radio_out_count});
  }
  EXPECT_EQ(robot.state(), RobotState::kRunning);
  EXPECT_EQ(ground.report().state, RobotState::kRunning);
  EXPECT_EQ(robot.robot.motion().speed_mm_per_s, 100);
  EXPECT_EQ(ground.rejected_frames(), 0U);
  ASSERT_TRUE(ground.report().answer.has_value());
  EXPECT_EQ(ground.report().answer->op, static_cast<uint8_t>(CommandOp::kDrive));
  EXPECT_EQ(ground.report().answer->result, static_cast<uint8_t>(RequestResult::kDone));
}

TEST(GroundStation, WithAnotherKeyTheRobotStaysDisarmed) {
  CommandKey key = test_key();
  key.bytes[0] ^= 0x80U;
  GroundStation ground(true, std::nullopt, nullptr, key);
  TestRobot robot;
  robot.heartbeats = false;
  for (uint64_t tick = 0; tick < 2000; ++tick) {
    const std::vector<uint8_t> up = ground.transmit(tick * 10000);
    robot.queue.insert(robot.queue.end(), up.begin(), up.end());
    robot.tick();
    ground.receive(tick * 10000, {robot.output.radio_out, robot.output.radio_out_count});
  }
  EXPECT_EQ(robot.state(), RobotState::kDisarmed);
  ASSERT_TRUE(ground.report().answer.has_value());
  EXPECT_EQ(ground.report().answer->result, static_cast<uint8_t>(RequestResult::kLockedOut));
}

// Position fixes of the simulated camera.

struct Fixes {
  std::vector<std::uint64_t> ticks;
  std::vector<DriveArgument> places;
};

Fixes fixes(const PositionFixOptions& options, std::uint64_t ticks, std::uint64_t seed = 1,
            double x_m = 1.0, double y_m = -0.5) {
  PositionFixes camera(seed, options);
  Fixes all;
  for (std::uint64_t tick = 0; tick < ticks; ++tick) {
    if (const auto fix = camera.at(tick, x_m, y_m)) {
      all.ticks.push_back(tick);
      all.places.push_back(*fix);
    }
  }
  return all;
}

TEST(PositionFixes, ComeAtTheirPeriodBetweenHeartbeatsAndCommands) {
  EXPECT_TRUE(fixes({0.0, 0.0, 0.0, 0.0}, 100'000).ticks.empty());
  const Fixes all = fixes({1.0, 0.0, 0.0, 0.0}, 10'000);
  ASSERT_EQ(all.ticks.size(), 100U);
  for (std::size_t i = 0; i < all.ticks.size(); ++i) {
    EXPECT_EQ(all.ticks[i], 7 + 100 * i);
    EXPECT_EQ(all.places[i].speed_mm_per_s, 100) << "cm";
    EXPECT_EQ(all.places[i].turn_ddeg_per_s, -50);
  }
  for (const std::uint64_t tick : fixes({0.25, 0.0, 0.0, 0.0}, 10'000).ticks) {
    EXPECT_NE(tick % 20, 0U) << "heartbeat";
    EXPECT_NE(tick % 25, 12U) << "command";
  }
}

TEST(PositionFixes, NoiseIsNormalOnBothAxes) {
  const Fixes all = fixes({0.25, 0.05, 0.0, 0.0}, 2'000'000);
  double sum[2] = {0.0, 0.0};
  double squares[2] = {0.0, 0.0};
  double products = 0.0;
  for (const DriveArgument& it : all.places) {
    const double x = it.speed_mm_per_s - 100.0;
    const double y = it.turn_ddeg_per_s + 50.0;
    sum[0] += x;
    sum[1] += y;
    squares[0] += x * x;
    squares[1] += y * y;
    products += x * y;
  }
  const double n = static_cast<double>(all.places.size());
  ASSERT_EQ(n, 80'000);
  for (int axis = 0; axis < 2; ++axis) {
    EXPECT_NEAR(sum[axis] / n, 0.0, 0.1);
    // 5 cm, and rounding to whole ones: 1 / 12.
    EXPECT_NEAR(std::sqrt(squares[axis] / n), std::sqrt(25.0 + 1.0 / 12.0), 0.1);
  }
  EXPECT_NEAR(products / n / 25.0, 0.0, 0.02);
}

TEST(PositionFixes, OutagesHideWhatWouldHaveBeenSent) {
  const PositionFixOptions with = {1.0, 0.02, 60.0, 10.0};
  const PositionFixOptions without = {1.0, 0.02, 0.0, 10.0};
  const Fixes some = fixes(with, 10'000'000);
  const Fixes all = fixes(without, 10'000'000);
  EXPECT_NEAR(static_cast<double>(some.ticks.size()) / static_cast<double>(all.ticks.size()),
              60.0 / 70.0, 0.02);
  std::size_t i = 0;
  int outages = 0;
  for (std::size_t k = 0; k < some.ticks.size(); ++k) {
    while (all.ticks[i] != some.ticks[k]) ++i;
    EXPECT_EQ(all.places[i].speed_mm_per_s, some.places[k].speed_mm_per_s) << "the same noise";
    if (k > 0 && some.ticks[k] - some.ticks[k - 1] >= 1000) ++outages;
  }
  EXPECT_NEAR(outages, 100'000.0 / 70.0, 150);
}

TEST(PositionFixes, OfASeedAreAlwaysTheSame) {
  const PositionFixOptions options = {1.0, 0.02, 60.0, 10.0};
  EXPECT_EQ(fixes(options, 100'000, 3).ticks, fixes(options, 100'000, 3).ticks);
  EXPECT_NE(fixes(options, 100'000, 3).ticks, fixes(options, 100'000, 4).ticks);
}

TEST(PositionFixes, StopAtTheEndOfTheirRange) {
  const Fixes far = fixes({1.0, 0.0, 0.0, 0.0}, 100, 1, 30.0, -1e9);
  ASSERT_EQ(far.places.size(), 1U);
  EXPECT_EQ(far.places[0].speed_mm_per_s, 2047);
  EXPECT_EQ(far.places[0].turn_ddeg_per_s, -2047);
}

}  // namespace

}  // namespace screed
