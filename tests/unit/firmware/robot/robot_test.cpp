// The whole firmware core, samples in and outputs out.
#include "firmware/robot/robot.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <map>

#include "tests/unit/firmware/robot/driving_robot.h"

namespace screed {
namespace {

bool idle(const TestRobot& robot) {
  return robot.output.duty_left == 0 && robot.output.duty_right == 0;
}

TEST(Robot, DrivesNothingUntilItIsArmedAndRuns) {
  TestRobot robot(drive_parameters());
  for (int tick = 0; tick < 600; ++tick) {
    robot.send(robot.command(CommandOp::kDrive, {200, 0}));
    robot.send(robot.command(CommandOp::kRun));
    robot.tick();
    ASSERT_TRUE(idle(robot));
  }
  robot.queue.clear();
  robot.send(robot.command(CommandOp::kArm));
  robot.run(3);
  EXPECT_EQ(robot.state(), RobotState::kArmed);
  EXPECT_TRUE(idle(robot));
}

TEST(Robot, TheFirstTickTakesAnyEncoderCountAsZero) {
  TestRobot robot;
  robot.sample.encoder_left = 54321;
  robot.sample.encoder_right = 12345;
  robot.run(10);
  EXPECT_EQ(robot.robot.position().mm(kX), 0);
  EXPECT_EQ(robot.robot.position().mm(kY), 0);
  EXPECT_EQ(robot.robot.drive().speed_left_dmm_per_s(), 0);
}

TEST(Robot, AWrapOfTheEncoderCountersHasNoEffect) {
  for (const int16_t speed : {static_cast<int16_t>(100), static_cast<int16_t>(-100)}) {
    TestRobot plain(drive_parameters());
    TestRobot wrapping(drive_parameters());
    wrapping.sample.encoder_left = speed > 0 ? 65500 : 30;
    wrapping.sample.encoder_right = speed > 0 ? 65300 : 300;
    for (TestRobot* robot : {&plain, &wrapping}) {
      robot->start();
      robot->send(robot->command(CommandOp::kDrive, {speed, 0}));
    }
    for (int tick = 0; tick < 400; ++tick) {
      plain.tick();
      wrapping.tick();
      ASSERT_EQ(plain.output.duty_left, wrapping.output.duty_left);
      ASSERT_EQ(plain.output.duty_right, wrapping.output.duty_right);
      ASSERT_EQ(plain.robot.position().mm(kX), wrapping.robot.position().mm(kX));
    }
    EXPECT_NE(plain.robot.position().mm(kX), 0);
  }
}

TEST(Robot, AWrapOfTheClockHasNoEffect) {
  TestRobot robot = driving_robot(100);
  robot.sample.time_us = UINT32_MAX - 5000;
  robot.run(300);
  EXPECT_EQ(robot.state(), RobotState::kRunning);
  EXPECT_NEAR(robot.left.speed_mm_per_s, 100, 10.0);
}

TEST(Robot, DriveCommandsAreFollowedWithTheirSign) {
  TestRobot robot(drive_parameters());
  robot.start();
  robot.send(robot.command(CommandOp::kDrive, {-120, 450}));  // 45 degrees/s
  robot.run(5);
  EXPECT_EQ(robot.robot.motion().speed_mm_per_s, -120);
  EXPECT_NEAR(robot.robot.motion().yaw_rate, 8192, 2);
  robot.send(robot.command(CommandOp::kDrive, {0, -2047}));  // beyond half a turn a second
  robot.run(5);
  EXPECT_EQ(robot.robot.motion().yaw_rate, -32767);
}

TEST(Robot, StopRampsDownAndTheDriveCommandIsForgotten) {
  TestRobot robot = driving_robot(200);
  robot.send(robot.command(CommandOp::kStop));
  robot.run(2);  // one tick in two looks at commands
  EXPECT_EQ(robot.state(), RobotState::kStopped);
  EXPECT_FALSE(idle(robot));
  robot.run(100);
  EXPECT_TRUE(idle(robot));
  robot.send(robot.command(CommandOp::kRun));
  robot.run(100);
  EXPECT_EQ(robot.state(), RobotState::kRunning);
  EXPECT_EQ(robot.robot.motion().speed_mm_per_s, 0);
}

TEST(Robot, ARepeatedCommandIsDoneOnceAndAnsweredEveryTime) {
  TestRobot robot(drive_parameters());
  robot.run(600);
  const CanFrame arm = robot.command(CommandOp::kArm);
  for (int i = 0; i < 5; ++i) {
    robot.send(arm);
    const auto answer = robot.answer();
    ASSERT_TRUE(answer.has_value()) << i;
    EXPECT_EQ(answer->result, static_cast<uint8_t>(RequestResult::kDone)) << i;
    EXPECT_EQ(robot.state(), RobotState::kArmed);
  }
  EXPECT_EQ(robot.robot.gate().refused(), 0);
}

// ---- faults on the way through the whole core

TEST(RobotFaults, HeartbeatStopsFault1) {
  TestRobot robot = driving_robot(200);
  while (robot.ticks % 20 != 1) robot.tick();  // a heartbeat has just come
  robot.heartbeats = false;
  robot.run(49);
  EXPECT_EQ(robot.state(), RobotState::kRunning);
  robot.run(2);
  EXPECT_EQ(robot.state(), RobotState::kStopped);
  robot.run(60);
  EXPECT_NEAR(robot.left.speed_mm_per_s, 0.0, 5.0);
  robot.run(41);
  EXPECT_EQ(robot.state(), RobotState::kDisarmed);
  robot.heartbeats = true;
  robot.run(300);
  EXPECT_EQ(robot.state(), RobotState::kDisarmed);  // 2: does not arm by itself
}

TEST(RobotFaults, FrozenAliveCounterIsLossFault12) {
  TestRobot robot = driving_robot(200);
  while (robot.ticks % 20 != 1) robot.tick();
  robot.heartbeats = false;
  const CanFrame frozen = robot.heartbeat();
  int ticks = 0;
  while (robot.state() == RobotState::kRunning && ticks < 500) {
    if (ticks % 20 == 0) robot.send(frozen);
    robot.tick();
    ++ticks;
  }
  EXPECT_LE(ticks, 52);
}

TEST(RobotFaults, DamagedLinesAreCountedAndDoNothingFault5) {
  TestRobot ready(drive_parameters());
  ready.run(600);
  const CanFrame arm = ready.command(CommandOp::kArm);
  uint8_t line[kSlcanLineMax];
  const uint8_t length = slcan_encode(arm, line);
  for (uint8_t at = 0; at + 1 < length; ++at) {
    for (int bit = 0; bit < 8; ++bit) {
      // Flipped case of a hex digit is the same digit.
      if (bit == 5 && line[at] >= 'A' && line[at] <= 'F') continue;
      std::vector<uint8_t> bytes(line, line + length);
      bytes[at] = static_cast<uint8_t>(bytes[at] ^ (1U << bit));
      TestRobot robot = ready;  // with its patience for wrong MACs
      robot.queue.insert(robot.queue.end(), bytes.begin(), bytes.end());
      robot.run(2);
      ASSERT_EQ(robot.state(), RobotState::kDisarmed) << static_cast<int>(at) << " " << bit;
    }
  }
}

TEST(RobotFaults, EmergencyStopCutsThePowerInItsTick) {
  TestRobot robot = driving_robot(200);
  robot.send(robot.emergency_stop());
  robot.tick();
  EXPECT_TRUE(idle(robot));
  EXPECT_EQ(robot.robot.supervisor().faults(), Fault::kEmergencyStop);
  EXPECT_EQ(robot.output.leds & kLedRed, kLedRed);
  EXPECT_EQ(robot.output.leds & kLedYellow, 0);
}

TEST(RobotFaults, OneDeadEncoderFault21) {
  // At half speed the controller first has to raise the duty to where standing still is a stall;
  // the 300 ms of a stalled track (fault 24) hold there, the 200 ms of a dead encoder only near
  // full speed.
  struct Case {
    int16_t speed;
    int deadline_ticks;
  };
  for (const Case& c : {Case{200, 20}, Case{100, 30}, Case{-100, 30}}) {
    TestRobot robot = driving_robot(c.speed);
    robot.right_encoder_dead = true;
    int ticks = 0;
    while (!idle(robot) && ticks < 500) {
      robot.tick();
      ++ticks;
    }
    EXPECT_LE(ticks, c.deadline_ticks) << c.speed;
    EXPECT_EQ(robot.robot.supervisor().faults(), Fault::kStallRight);
  }
}

TEST(RobotFaults, ShortAndForeignFramesAreHarmless) {
  TestRobot robot(drive_parameters());
  robot.run(600);
  for (const uint16_t id :
       {kIdGroundHeartbeat, kIdEmergencyStop, kIdCommand, kIdHeartbeat, kIdBaro}) {
    for (uint8_t size = 0; size <= 8; ++size) {
      CanFrame frame{id, size, {}};  // no protection at all
      frame.data[2] = 1;
      robot.send(frame);
      robot.run(2);
      ASSERT_EQ(robot.state(), RobotState::kDisarmed);
    }
  }
}

TEST(RobotFaults, BytesBeyondTheCapacityAreNotRead) {
  TestRobot robot(drive_parameters());
  robot.heartbeats = false;
  robot.run(600);
  // A count that no receiver can have, and behind the sample what would be a heartbeat.
  struct {
    SensorSample sample;
    uint8_t behind[192];
  } memory{};
  uint8_t line[kSlcanLineMax];
  const uint8_t length = slcan_encode(robot.heartbeat(), line);
  memory.sample = robot.sample;
  std::memset(memory.sample.radio_in, '\r', sizeof memory.sample.radio_in);
  memory.behind[0] = '\r';
  std::memcpy(memory.behind + 1, line, length);
  memory.sample.radio_in_count = 255;
  memory.sample.time_us += kTickPeriod_us;
  robot.robot.tick(memory.sample, robot.output);
  robot.send(robot.command(CommandOp::kArm));
  const auto answer = robot.answer();
  ASSERT_TRUE(answer.has_value());
  EXPECT_EQ(answer->result, static_cast<uint8_t>(message::CommandAckResult::kNoLink))
      << "no heartbeat was received";
}

// ---- purity

TEST(Robot, SameSamplesSameBytes) {
  Parameters parameters;
  TestRobot world(parameters);
  Robot one(kBoard, parameters, credentials_of(test_key()));
  Robot two(kBoard, parameters, credentials_of(test_key()));
  RobotOutput a{};
  RobotOutput b{};
  std::memset(static_cast<void*>(&b), 0xA5, sizeof b);
  world.start();
  uint32_t noise = 1;
  for (int tick = 0; tick < 3000; ++tick) {
    world.tick();
    SensorSample sample = world.sample;
    for (int16_t& value : sample.imu.gyro()) {
      noise = noise * 1664525U + 1013904223U;
      value = static_cast<int16_t>(noise >> 20);
    }
    one.tick(sample, a);
    two.tick(sample, b);
    ASSERT_EQ(a.duty_left, b.duty_left);
    ASSERT_EQ(a.duty_right, b.duty_right);
    ASSERT_EQ(a.leds, b.leds);
    ASSERT_EQ(a.radio_out_count, b.radio_out_count);
    ASSERT_EQ(std::memcmp(a.radio_out, b.radio_out, a.radio_out_count), 0);
  }
}

TEST(Robot, ACopyGoesOnLikeTheOriginal) {
  Parameters parameters;
  TestRobot robot(parameters);
  robot.start();
  robot.run(500);
  TestRobot copy = robot;
  for (int tick = 0; tick < 1000; ++tick) {
    robot.tick();
    copy.tick();
    ASSERT_EQ(robot.output.duty_left, copy.output.duty_left);
    ASSERT_EQ(robot.output.duty_right, copy.output.duty_right);
  }
}

TEST(Robot, GarbageSamplesNeverDriveBeyondTheDutyRange) {
  Parameters parameters;
  parameters.standalone() = 1;
  parameters.standalone_delay() = 0;
  parameters.tilt_limit() = 9000;
  parameters.battery_low() = 0;
  TestRobot robot(parameters);
  robot.heartbeats = false;
  robot.run(700);
  EXPECT_EQ(robot.state(), RobotState::kRunning);
  uint32_t noise = 7;
  const auto next = [&noise] { return noise = noise * 1664525U + 1013904223U; };
  for (int tick = 0; tick < 20000; ++tick) {
    SensorSample sample{};
    auto* bytes = reinterpret_cast<uint8_t*>(&sample);
    for (size_t i = 0; i < sizeof sample; ++i) bytes[i] = static_cast<uint8_t>(next() >> 24);
    robot.robot.tick(sample, robot.output);
    ASSERT_LE(std::abs(robot.output.duty_left), kDutyMax);
    ASSERT_LE(std::abs(robot.output.duty_right), kDutyMax);
    ASSERT_LE(robot.output.radio_out_count, kRadioOutCapacity);
  }
}

}  // namespace
}  // namespace screed
