// What the robot says of itself over the radio, against what it was given and what it knows.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "firmware/math/crc16.h"
#include "tests/unit/test_robot.h"

namespace screed {
namespace {

/// A robot whose frames are taken off the line in the tick they are sent in.
class HeardRobot : public TestRobot {
 public:
  using TestRobot::TestRobot;

  /// One tick and the frames sent in it.
  std::vector<CanFrame> hear() {
    tick();
    std::vector<CanFrame> frames;
    CanFrame frame{};
    for (uint8_t at = 0; at < output.radio_out_count; ++at) {
      if (!parser_.feed(output.radio_out[at], frame)) continue;
      EXPECT_TRUE(frame.id == kIdCommandAck || e2e_check(frame.id, frame.data, frame.size));
      frames.push_back(frame);
    }
    return frames;
  }
  /// The next message of a type, within 2 s.
  template <class Message>
  Message next() {
    for (int i = 0; i < 200; ++i) {
      for (const CanFrame& frame : hear()) {
        if (frame.id == Message::kId) return Message::unpack(frame.data);
      }
    }
    ADD_FAILURE() << "no such message in 2 s";
    return {};
  }
  /// All messages of a type within so many ticks.
  template <class Message>
  std::vector<Message> all(int duration) {
    std::vector<Message> messages;
    for (int i = 0; i < duration; ++i) {
      for (const CanFrame& frame : hear()) {
        if (frame.id == Message::kId) messages.push_back(Message::unpack(frame.data));
      }
    }
    return messages;
  }

 private:
  SlcanParser parser_;
};

Parameters driven() {
  Parameters parameters;
  parameters.algorithm() = static_cast<int16_t>(LevelingAlgorithm::kDrive);
  return parameters;
}

/// 0.01 degrees, from 0 to below a whole turn.
uint16_t heading_cdeg(const AttitudeAngles& angles) {
  return static_cast<uint16_t>(uint32_t{static_cast<uint16_t>(angles.heading)} * 36000U >> 16U);
}

/// A message of a tick against the robot at the end of that tick.
void compare(const HeardRobot& robot, const CanFrame& frame) {
  const Robot& core = robot.robot;
  const AttitudeAngles angles = core.attitude().angles();
  const SensorSample& sample = robot.sample;
  switch (frame.id) {
    case message::Heartbeat::kId: {
      const auto it = message::Heartbeat::unpack(frame.data);
      EXPECT_EQ(it.state, static_cast<int>(core.supervisor().state()));
      EXPECT_EQ(it.faults, core.supervisor().reported_faults());
      EXPECT_EQ(it.link_alive, core.supervisor().link_alive() ? 1 : 0);
      EXPECT_EQ(it.boot_epoch, kFirstBootEpoch);
      EXPECT_EQ(it.freshness, core.gate().counter());
      break;
    }
    case message::Attitude::kId: {
      const auto it = message::Attitude::unpack(frame.data);
      EXPECT_NEAR(it.roll, angles.roll * 36000.0 / 65536.0, 1.0);
      EXPECT_NEAR(it.pitch, angles.pitch * 36000.0 / 65536.0, 1.0);
      EXPECT_EQ(it.heading, heading_cdeg(angles));
      break;
    }
    case message::Leveling::kId: {
      const auto it = message::Leveling::unpack(frame.data);
      EXPECT_EQ(it.state, static_cast<int>(core.leveling().state()));
      EXPECT_EQ(it.algorithm, static_cast<int>(core.leveling().algorithm()));
      EXPECT_EQ(it.peaks, core.leveling().peaks());
      EXPECT_EQ(it.speed, core.motion().speed_mm_per_s);
      EXPECT_NEAR(it.turn_rate, core.motion().yaw_rate * 36000.0 / 65536.0, 1.0);
      break;
    }
    case message::Motors::kId: {
      const auto it = message::Motors::unpack(frame.data);
      EXPECT_EQ(it.duty_left, robot.output.duty_left);
      EXPECT_EQ(it.duty_right, robot.output.duty_right);
      EXPECT_EQ(it.slip, core.slip_watch().slips() ? 1 : 0);
      EXPECT_EQ(it.stuck, core.slip_watch().stuck() ? 1 : 0);
      EXPECT_EQ(it.missed_edges, sample.encoder_errors);
      break;
    }
    case message::Odometry::kId: {
      const auto it = message::Odometry::unpack(frame.data);
      EXPECT_EQ(it.x, core.position().mm(kX));
      EXPECT_EQ(it.y, core.position().mm(kY));
      EXPECT_EQ(it.heading, heading_cdeg(core.attitude().angles()));
      break;
    }
    case message::Position::kId: {
      const auto it = message::Position::unpack(frame.data);
      Place place;
      core.position().get(place);
      EXPECT_EQ(it.sigma_x, place.sigma[kX]);
      EXPECT_EQ(it.sigma_y, place.sigma[kY]);
      EXPECT_EQ(it.sigma_heading, core.attitude().heading_sigma());
      EXPECT_EQ(it.travel_share, core.slip_watch().travel_share());
      break;
    }
    case message::AccelRaw::kId:
      EXPECT_EQ(message::AccelRaw::unpack(frame.data).z, sample.imu.accel()[2]);
      break;
    default:
      break;
  }
}

class RobotDownlinkTo : public ::testing::TestWithParam<bool> {};

TEST_P(RobotDownlinkTo, EveryMessageSaysWhatTheRobotKnowsInThatTick) {
  HeardRobot robot(driven());
  if (GetParam()) {  // a quarter turn from where it looks else
    robot.sample.imu.mag()[0] = 1217;
    robot.sample.imu.mag()[1] = 0;
  }
  std::set<uint16_t> seen;
  std::set<int> states;
  const auto hear = [&](int ticks) {
    for (int i = 0; i < ticks; ++i) {
      for (const CanFrame& frame : robot.hear()) {
        compare(robot, frame);
        seen.insert(frame.id);
        if (frame.id == message::Heartbeat::kId) {
          states.insert(message::Heartbeat::unpack(frame.data).state);
        }
      }
    }
  };
  hear(600);
  robot.send(robot.command(CommandOp::kArm));
  hear(40);
  robot.send(robot.command(CommandOp::kRun));
  hear(4);
  robot.send(robot.command(CommandOp::kDrive, {150, 100}));
  hear(300);
  const int32_t x_mm = std::abs(robot.robot.position().mm(kX));
  const int32_t y_mm = std::abs(robot.robot.position().mm(kY));
  EXPECT_GT(std::max(x_mm, y_mm), 10) << "little: nothing but its tracks says that it moves";
  EXPECT_EQ(x_mm > y_mm, !GetParam()) << x_mm << " " << y_mm;
  robot.sample.imu.accel()[1] = 700;  // rolls
  robot.sample.encoder_errors = 9;
  hear(100);
  robot.sample.imu.accel()[1] = 0;
  robot.send(robot.command(CommandOp::kStop));
  hear(60);
  robot.heartbeats = false;  // is disarmed for that
  hear(200);
  robot.send(robot.emergency_stop());
  hear(40);
  EXPECT_EQ(states, (std::set<int>{0, 1, 2, 3, 4}));
  EXPECT_GE(seen.size(), 14U);
}

INSTANTIATE_TEST_SUITE_P(Directions, RobotDownlinkTo, ::testing::Bool());

TEST(RobotDownlink, AnIncliningRobotSaysItsAngles) {
  HeardRobot robot;
  robot.sample.imu.accel()[0] = static_cast<int16_t>(std::lround(4098.0 * std::sin(0.2)));
  robot.sample.imu.accel()[2] = static_cast<int16_t>(std::lround(4098.0 * std::cos(0.2)));
  robot.run(1000);
  EXPECT_NEAR(robot.next<message::Attitude>().pitch / 100.0, 0.2 * 180.0 / 3.14159265, 0.3);
  EXPECT_NEAR(robot.next<message::Attitude>().roll, 0, 30);
}

TEST(RobotDownlink, RollIsThatOfARobotUpsideDown) {
  HeardRobot robot;
  robot.sample.imu.accel()[2] = -4098;
  robot.run(200);
  EXPECT_NEAR(std::abs(robot.next<message::Attitude>().roll), 18000, 60);
}

TEST(RobotDownlink, TheHeadingIsWithinATurnAllRound) {
  for (int degrees = 0; degrees < 360; degrees += 15) {
    HeardRobot robot;
    // North is where the field points; a robot that looks east sees it on its left.
    const double heading_rad = degrees * 3.14159265 / 180.0;
    robot.sample.imu.mag()[0] = static_cast<int16_t>(std::lround(1217.0 * std::sin(heading_rad)));
    robot.sample.imu.mag()[1] = static_cast<int16_t>(std::lround(1217.0 * std::cos(heading_rad)));
    robot.run(700);
    const int said = robot.next<message::Attitude>().heading;
    EXPECT_LT(said, 36000);
    EXPECT_NEAR(std::remainder(said / 100.0 - degrees, 360.0), 0.0, 0.5);
    EXPECT_EQ(robot.next<message::Odometry>().heading, said);
  }
}

// ---- what the sensors say

TEST(RobotDownlink, RawVectorsAndEncodersGoAsTheyCome) {
  HeardRobot robot;
  for (int16_t i = 0; i < 3; ++i) {
    robot.sample.imu.accel()[i] = static_cast<int16_t>(-4098 + i);
    robot.sample.imu.gyro()[i] = static_cast<int16_t>(100 + i);
    robot.sample.imu.mag()[i] = static_cast<int16_t>(INT16_MIN + i);
  }
  robot.sample.encoder_left = 65535;
  robot.sample.encoder_right = 1;
  robot.sample.encoder_errors = 77;
  const auto accel = robot.next<message::AccelRaw>();
  EXPECT_EQ(accel.x, -4098);
  EXPECT_EQ(accel.y, -4097);
  EXPECT_EQ(accel.z, -4096);
  const auto gyro = robot.next<message::GyroRaw>();
  EXPECT_EQ(gyro.y, 101);
  EXPECT_EQ(gyro.z, 102);
  EXPECT_EQ(robot.next<message::MagRaw>().x, INT16_MIN);
  const auto encoders = robot.next<message::Encoders>();
  EXPECT_EQ(encoders.left, 65535);
  EXPECT_EQ(encoders.right, 1);
  EXPECT_EQ(encoders.interval * 4, 10000);
  EXPECT_EQ(robot.next<message::Motors>().missed_edges, 77);
}

// As the sensor says it: temperature 42.5 degC + raw / 480, pressure without its last four bits,
// 256 a hPa, less than its noise.
TEST(RobotDownlink, BaroKeepsTheSensorsResolution) {
  HeardRobot robot;
  robot.sample.pressure = static_cast<int32_t>(1013.25 * 4096);
  robot.sample.temperature = -10800;
  const auto it = robot.next<message::Baro>();
  EXPECT_EQ(it.pressure * 0.390625, 101325.0);
  EXPECT_EQ(it.temperature, -10800);
  robot.sample.pressure += 41;  // 0.01 hPa, the sensor's noise
  EXPECT_GE(robot.next<message::Baro>().pressure, it.pressure + 2);
  robot.sample.pressure = INT32_MIN;  // not a value of 24 bits: nonsense, but no overflow
  robot.next<message::Baro>();
}

TEST(RobotDownlink, HealthOfTheParts) {
  using Conditions = message::HealthConditions;
  HeardRobot robot;
  robot.run(700);
  robot.sample.reset_cause = static_cast<uint8_t>(message::HealthResetCause::kWatchdog);
  robot.sample.bus_errors = 200;
  robot.sample.radio_errors = 201;
  robot.sample.chips_failing = Conditions::kGyroChip | Conditions::kBaroChip;
  const auto health = robot.next<message::Health>();
  EXPECT_EQ(health.reset_cause, 2);
  EXPECT_EQ(health.i2c_errors, 200);
  EXPECT_EQ(health.uart_errors, 201);
  EXPECT_EQ(health.conditions, Conditions::kGyroChip | Conditions::kBaroChip);
  robot.sample.chips_failing = 0;
  robot.sample.imu.mag()[0] = 4000;  // iron nearby
  robot.run(100);
  EXPECT_EQ(robot.next<message::Health>().conditions, Conditions::kMagDisturbed);
}

TEST(RobotDownlink, TheLongestTickIsThatSinceTheLastMessage) {
  HeardRobot robot;
  EXPECT_EQ(robot.next<message::Health>().longest_tick, 0);
  robot.sample.last_tick_us = 5000;
  robot.tick();
  robot.sample.last_tick_us = 100;
  EXPECT_EQ(robot.next<message::Health>().longest_tick, 5000);
  EXPECT_EQ(robot.next<message::Health>().longest_tick, 100);
}

// Per cent of a tick, rounded down; 255 stands for all above as well.
TEST(RobotDownlink, TheLoadIsInPerCent) {
  HeardRobot robot;
  const std::map<uint16_t, int> loads = {{99, 0},      {100, 1},     {4321, 43},       {25499, 254},
                                         {25500, 255}, {25600, 255}, {UINT16_MAX, 255}};
  for (const auto& [time_us, load] : loads) {
    robot.sample.last_tick_us = time_us;
    EXPECT_EQ(robot.next<message::Power>().cpu_load, load) << time_us;
  }
}

TEST(RobotDownlink, OfThePeaksTheLowerByteIsSaid) {
  Parameters parameters;
  parameters.algorithm() = static_cast<int16_t>(LevelingAlgorithm::kSpinOnPeak);
  parameters.spin_time() = 100;
  parameters.escape_attempts() = 0;  // no ground: the slip watch calls it stuck
  HeardRobot robot(parameters);
  robot.start();
  // It rocks: half a second up by 17 degrees, a second down, half a second up again.
  double pitch_rad = 0.0;
  for (int tick = 0; robot.robot.leveling().peaks() < 258 && tick < 100000; ++tick) {
    const int phase = tick % 200;
    const int rate = phase < 50 || phase >= 150 ? -500 : 500;  // counts; nose up is negative
    robot.sample.imu.gyro()[1] = static_cast<int16_t>(rate);
    pitch_rad -= rate * 0.07 * 3.14159265 / 180.0 * 0.01;
    robot.sample.imu.accel()[0] = static_cast<int16_t>(std::lround(4098.0 * std::sin(pitch_rad)));
    robot.sample.imu.accel()[2] = static_cast<int16_t>(std::lround(4098.0 * std::cos(pitch_rad)));
    robot.tick();
  }
  ASSERT_EQ(robot.robot.leveling().peaks(), 258);
  EXPECT_EQ(robot.next<message::Leveling>().peaks, 2);
}

// ---- the battery

TEST(RobotDownlink, TheBatteryIsTheSumOfEightConversionsInTheBoardsUnit) {
  HeardRobot robot;
  for (const int sum : {0, 1, 3932, 8184}) {
    robot.sample.battery = static_cast<uint16_t>(sum);
    robot.run(2);
    const double expected_mv = sum * static_cast<double>(kBoard.battery_uv_per_lsb) / 1000.0;
    EXPECT_NEAR(robot.next<message::Power>().battery, expected_mv, 1.0) << sum;
  }
  // No sensor can say that: the bits beyond its range are not looked at.
  robot.sample.battery = 65535;
  robot.run(2);
  EXPECT_NEAR(robot.next<message::Power>().battery, 8.191 * kBoard.battery_uv_per_lsb, 1.0);
}

// ---- events and lamps

TEST(RobotDownlink, ItsStartIsToldOnceWithItsCause) {
  HeardRobot robot;
  robot.sample.reset_cause = static_cast<uint8_t>(message::HealthResetCause::kWatchdog);
  const auto events = robot.all<message::Event>(300);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].code, static_cast<int>(message::EventCode::kStarted));
  EXPECT_EQ(events[0].argument, static_cast<int>(message::HealthResetCause::kWatchdog));
}

TEST(RobotDownlink, EachChangeOfStateIsToldWithTheFaults) {
  HeardRobot robot;
  robot.all<message::Event>(600);
  robot.send(robot.command(CommandOp::kArm));
  auto events = robot.all<message::Event>(20);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].code, static_cast<int>(message::EventCode::kState));
  EXPECT_EQ(events[0].argument, static_cast<int>(RobotState::kArmed));
  EXPECT_TRUE(robot.all<message::Event>(200).empty()) << "nothing changed";
  robot.sample.imu.accel()[1] = 4098;
  robot.sample.imu.accel()[2] = 0;
  events = robot.all<message::Event>(100);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].argument, Fault::kTilt * 256 + static_cast<int>(RobotState::kFault));
}

TEST(RobotDownlink, ALockOutIsToldWithItsTime) {
  HeardRobot robot;
  robot.all<message::Event>(600);
  std::vector<message::Event> events;
  for (int i = 0; i < 12; ++i) {
    CanFrame wrong = robot.command(CommandOp::kArm);
    wrong.data[7] ^= 0x55U;
    robot.send(wrong);
    for (const message::Event& event : robot.all<message::Event>(8)) events.push_back(event);
  }
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].code, static_cast<int>(message::EventCode::kLockedOut));
  EXPECT_NEAR(events[0].argument, CommandGate::kLockoutTicks, 1);
}

TEST(RobotDownlink, LampsSayMotorsFaultAndLink) {
  TestRobot robot(driven());
  robot.run(600);
  EXPECT_EQ(robot.output.leds, kLedGreen);
  robot.send(robot.command(CommandOp::kArm));
  robot.run(4);
  EXPECT_EQ(robot.output.leds, kLedGreen);
  robot.send(robot.command(CommandOp::kRun));
  robot.run(4);
  EXPECT_EQ(robot.output.leds, kLedGreen | kLedYellow);
  robot.heartbeats = false;
  robot.run(80);
  EXPECT_EQ(robot.output.leds, kLedYellow) << "ramps down without the link";
  robot.send(robot.emergency_stop());
  robot.run(2);
  EXPECT_EQ(robot.output.leds, kLedRed);
}

// ---- the uplink's counts

TEST(RobotDownlink, LinkCountsWhatArrivedAndWhatWasRefused) {
  HeardRobot robot;
  robot.heartbeats = false;
  robot.run(300);
  const auto before = robot.next<message::Link>();
  EXPECT_EQ(before.quality, 0);
  EXPECT_EQ(before.frames_received, 0);
  for (int i = 0; i < 3; ++i) {
    robot.send(robot.heartbeat());
    robot.run(4);
  }
  CanFrame damaged = robot.heartbeat();
  damaged.data[4] ^= 1U;
  robot.send(damaged);
  robot.run(2);
  CanFrame cut = robot.command(CommandOp::kArm);
  cut.size = 7;
  robot.send(cut);
  robot.run(2);
  CanFrame wrong = robot.command(CommandOp::kArm);
  wrong.data[6] ^= 1U;
  robot.send(wrong);
  robot.run(4);
  for (const char letter : {'t', '1', '2', '\r'})
    robot.queue.push_back(static_cast<uint8_t>(letter));
  robot.run(2);
  const auto after = robot.next<message::Link>();
  EXPECT_EQ(after.frames_received, 4) << "three heartbeats, and a command of whatever MAC";
  EXPECT_EQ(after.frames_rejected, 2);
  EXPECT_EQ(after.commands_rejected, 1);
  EXPECT_EQ(after.lines_rejected, 1);
  EXPECT_EQ(after.quality, 60) << "of five a second";
}

TEST(RobotDownlink, ACommandWhileAnotherWaitsIsLostAndCounted) {
  HeardRobot robot;
  robot.run(600);
  const auto before = robot.next<message::Link>();
  // Both arrive in a tick: there is room for one.
  const CanFrame arm = robot.command(CommandOp::kArm);
  robot.send(arm);
  robot.send(robot.command(CommandOp::kRun));
  const auto answers = robot.all<message::CommandAck>(20);
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(answers[0].op, static_cast<int>(CommandOp::kArm));
  EXPECT_EQ(robot.state(), RobotState::kArmed);
  EXPECT_EQ(robot.next<message::Link>().frames_rejected, before.frames_rejected + 1);
}

TEST(RobotDownlink, FramesForOthersAreNotCountedAtAll) {
  HeardRobot robot;
  robot.heartbeats = false;
  robot.run(100);
  for (const uint16_t id : {kIdBaro, kIdHeartbeat}) {
    robot.send(CanFrame{id, 8, {}});
    robot.run(2);
  }
  const auto link = robot.next<message::Link>();
  EXPECT_EQ(link.frames_rejected, 0);
  EXPECT_EQ(link.frames_received, 0);
}

TEST(RobotDownlink, TheFirstHeartbeatIsASignOfLifeWhateverItsCounter) {
  for (uint8_t counter = 0; counter < 16; ++counter) {
    TestRobot robot;
    robot.heartbeats = false;
    robot.heartbeat_counter = counter;
    robot.run(10);
    EXPECT_FALSE(robot.robot.supervisor().link_alive());
    robot.send(robot.heartbeat());
    robot.run(2);
    EXPECT_TRUE(robot.robot.supervisor().link_alive()) << static_cast<int>(counter);
  }
}

TEST(RobotDownlink, AHeartbeatWhoseCounterStandsStillIsNoneHoweverItsTimeGoesOn) {
  TestRobot robot;
  robot.heartbeats = false;
  robot.run(10);
  for (uint32_t i = 0; i < 30; ++i) {
    uint8_t counter = 5;
    robot.send(TestRobot::protect(
        frame_of(message::GroundHeartbeat{robot.sample.time_us / 1000 + 3U * i}), counter));
    robot.run(20);
  }
  EXPECT_FALSE(robot.robot.supervisor().link_alive());
}

TEST(RobotDownlink, QualityIsTheShareOfTheLastSecondsHeartbeats) {
  HeardRobot robot;
  robot.heartbeats = false;
  robot.next<message::Link>();
  for (const int heard : {5, 4, 3, 0, 6, 9}) {
    for (int i = 0; i < heard; ++i) {
      robot.send(robot.heartbeat());
      robot.run(4);
    }
    EXPECT_EQ(robot.next<message::Link>().quality, std::min(100, 20 * heard));
  }
}

// The sample's time wraps after 71.6 minutes; the ground's clocks do not.
TEST(RobotDownlink, TimeGoesOnWhenTheSamplesTimeWraps) {
  HeardRobot robot;
  robot.sample.time_us = UINT32_MAX - 5000000U;
  uint32_t last_ms = robot.next<message::Time>().time;
  for (int second = 0; second < 10; ++second) {
    const uint32_t now_ms = robot.next<message::Time>().time;
    EXPECT_EQ(now_ms - last_ms, 1000U) << second;
    last_ms = now_ms;
  }
  EXPECT_GT(last_ms, UINT32_MAX / 1000U);
}

TEST(RobotDownlink, TimeEchoesTheLastHeartbeats) {
  HeardRobot robot;
  robot.heartbeats = false;
  robot.run(100);
  uint8_t counter = 5;
  robot.send(TestRobot::protect(frame_of(message::GroundHeartbeat{70000}), counter));
  robot.run(2);
  const auto time = robot.next<message::Time>();
  EXPECT_EQ(time.echo, 70000 - 65536);
  EXPECT_EQ(time.time, robot.sample.time_us / 1000);
}

// ---- answers

TEST(RobotDownlink, RefusalsSayWhatHelps) {
  HeardRobot robot;
  robot.run(600);
  const auto answer_to = [&](const CanFrame& command) {
    robot.send(command);
    const auto answer = robot.answer();
    EXPECT_TRUE(answer.has_value());
    return answer.value_or(message::CommandAck{});
  };
  EXPECT_EQ(answer_to(robot.command(CommandOp::kArm)).detail, 0) << "done";
  EXPECT_EQ(answer_to(robot.command(CommandOp::kArm)).detail, 0) << "wrong state";
  CanFrame wrong = robot.command(CommandOp::kRun);
  wrong.data[7] ^= 1U;
  auto answer = answer_to(wrong);
  EXPECT_EQ(answer.result, static_cast<int>(RequestResult::kBadMac));
  EXPECT_EQ(answer.detail, robot.robot.gate().counter());
  EXPECT_GT(answer.detail, 0);
  for (int i = 0; i < 12 && answer.result != static_cast<int>(RequestResult::kLockedOut); ++i) {
    wrong.data[7] = static_cast<uint8_t>(wrong.data[7] + 1);
    answer = answer_to(wrong);
  }
  ASSERT_EQ(answer.result, static_cast<int>(RequestResult::kLockedOut));
  EXPECT_GT(answer.detail, CommandGate::kLockoutTicks - 30);
  EXPECT_LE(answer.detail, CommandGate::kLockoutTicks);

  TestRobot tilted;
  tilted.sample.imu.accel()[1] = 4098;
  tilted.sample.imu.accel()[2] = 0;
  tilted.run(600);
  tilted.send(tilted.command(CommandOp::kArm));
  const auto refused = tilted.answer();
  ASSERT_TRUE(refused.has_value());
  EXPECT_EQ(refused->result, static_cast<int>(RequestResult::kFaultPresent));
  EXPECT_EQ(refused->detail, Fault::kTilt);
}

TEST(RobotDownlink, ARepeatedCommandsAnswerIsThatOfTheCommandAccepted) {
  HeardRobot robot;
  robot.run(600);
  const CanFrame arm = robot.command(CommandOp::kArm);
  robot.send(arm);
  ASSERT_TRUE(robot.answer().has_value());
  CanFrame wrong = robot.command(CommandOp::kRun);
  wrong.data[7] ^= 1U;
  robot.send(wrong);
  const auto refused = robot.answer();
  ASSERT_TRUE(refused.has_value());
  EXPECT_EQ(refused->result, static_cast<int>(RequestResult::kBadMac));
  robot.send(arm);
  const auto answers = robot.all<message::CommandAck>(20);
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(answers[0].op, static_cast<int>(CommandOp::kArm));
  EXPECT_EQ(answers[0].result, static_cast<int>(RequestResult::kDone));
}

// ---- what a committed parameter changes

TestRobot with_parameter(uint8_t index, int16_t value, const Parameters& parameters) {
  TestRobot robot(parameters);
  robot.run(600);
  uint8_t counter = 1;
  robot.send(TestRobot::protect(frame_of(message::ParamStage{index, value}), counter));
  uint8_t bytes[4];
  put_u16(bytes, index);
  put_u16(bytes + 2, static_cast<uint16_t>(value));
  robot.send(
      robot.signer.sign(CommandOp::kParameterCommit,
                        index | static_cast<uint32_t>(crc16_ccitt(bytes, sizeof bytes)) << 8));
  int16_t stored = 0;
  while (robot.ticks < 620) {
    robot.tick();
    if (robot.output.store_parameter == index + 1) stored = robot.output.store_value;
  }
  EXPECT_EQ(stored, value);
  return robot;
}

TEST(RobotDownlink, ACommittedParameterDrivesAsIfItHadBeenThereFromTheStart) {
  constexpr uint8_t kSpeedKp = Parameters::k_speed_kp;
  Parameters other = driven();
  other.speed_kp() = 5;
  ASSERT_NE(other.speed_kp(), Parameters{}.speed_kp());
  TestRobot committed = with_parameter(kSpeedKp, other.speed_kp(), driven());
  TestRobot born(other);
  TestRobot plain(driven());
  for (TestRobot* robot : {&committed, &born, &plain}) {
    while (robot->ticks < 700) robot->tick();
    for (const CommandOp op : {CommandOp::kArm, CommandOp::kRun}) {
      robot->send(robot->command(op));
      robot->run(4);
    }
    robot->send(robot->command(CommandOp::kDrive, {150, 0}));
    robot->run(20);
  }
  EXPECT_EQ(committed.output.duty_left, born.output.duty_left);
  EXPECT_EQ(committed.output.duty_right, born.output.duty_right);
  EXPECT_NE(committed.output.duty_left, plain.output.duty_left);
}

TEST(RobotDownlink, StartUpIsToldUntilItIsOver) {
  HeardRobot robot;
  const auto starting = [&robot] {
    return (robot.next<message::Health>().conditions & message::HealthConditions::kStarting) != 0;
  };
  EXPECT_TRUE(starting());
  robot.run(AttitudeEstimator::kStartTicks);
  EXPECT_TRUE(starting()) << "the standstill began it anew";
  robot.run(AttitudeEstimator::kRestTicks);
  EXPECT_FALSE(starting());
  // The chips' flags beside it are their own.
  robot.sample.chips_failing = ChipBit::kBaroChip;
  EXPECT_EQ(robot.next<message::Health>().conditions, ChipBit::kBaroChip);
}

TEST(RobotDownlink, ADisarmedRobotTellsWhatWouldPreventArming) {
  HeardRobot robot;
  robot.run(600);
  EXPECT_EQ(robot.next<message::Heartbeat>().faults, 0);
  robot.sample.battery = 2730;  // 5 V
  robot.run(200);
  const auto low = robot.next<message::Heartbeat>();
  EXPECT_EQ(low.state, static_cast<int>(RobotState::kDisarmed));
  EXPECT_EQ(low.faults, Fault::kBattery);
}

}  // namespace
}  // namespace screed
