// What a robot notices of its parts: IMU, motors and encoders, slip.
#include <gtest/gtest.h>
#include <cmath>
#include <cstdlib>
#include <initializer_list>

#include "firmware/robot/supervisor.h"
#include "tests/unit/firmware/robot/driving_robot.h"
#include "tests/unit/test_robot.h"

namespace screed {

namespace {

// How a robot takes the counts of its IMU: calibrated, and only new ones.

TEST(RobotImu, OffsetsOfTheImuAreTakenOffBeforeTheEstimate) {
  Parameters parameters;
  parameters.accel_offset_x() = 300;
  parameters.accel_offset_y() = -200;
  parameters.accel_offset_z() = 100;
  parameters.mag_offset_x() = 4150;
  parameters.mag_offset_y() = -4120;
  parameters.mag_offset_z() = 90;
  parameters.gyro_offset_x() = 25;
  parameters.gyro_offset_y() = -20;
  parameters.gyro_offset_z() = 15;
  TestRobot plain;
  TestRobot shifted(parameters);
  for (TestRobot* robot : {&plain, &shifted}) {
    robot->sample.imu.accel()[0] = 500;
    robot->sample.imu.accel()[1] = 400;
    robot->sample.imu.mag()[0] = 300;
  }
  for (int i = 0; i < 3; ++i) {
    const int16_t accel[] = {300, -200, 100};
    const int16_t mag[] = {4150, -4120, 90};
    const int16_t gyro[] = {25, -20, 15};
    shifted.sample.imu.accel()[i] = static_cast<int16_t>(shifted.sample.imu.accel()[i] + accel[i]);
    shifted.sample.imu.mag()[i] = static_cast<int16_t>(shifted.sample.imu.mag()[i] + mag[i]);
    shifted.sample.imu.gyro()[i] = static_cast<int16_t>(shifted.sample.imu.gyro()[i] + gyro[i]);
  }
  // The gyro's first axis has a last digit that moves: the same one in both.
  for (int tick = 0; tick < 800; ++tick) {
    plain.sample.imu.gyro()[0] = static_cast<int16_t>(tick % 2);
    plain.sample.imu.gyro()[1] = static_cast<int16_t>(tick % 5);
    plain.sample.imu.gyro()[2] = static_cast<int16_t>(tick % 3);
    for (int i = 0; i < 3; ++i) {
      const int16_t gyro[] = {25, -20, 15};
      shifted.sample.imu.gyro()[i] = static_cast<int16_t>(plain.sample.imu.gyro()[i] + gyro[i]);
    }
    for (TestRobot* robot : {&plain, &shifted}) {
      robot->sample.fresh = kFreshGyro | kFreshAccel | kFreshMag;
      robot->sample.time_us += kTickPeriod_us;
      robot->robot.tick(robot->sample, robot->output);
    }
    const AttitudeAngles a = plain.robot.attitude().angles();
    const AttitudeAngles b = shifted.robot.attitude().angles();
    ASSERT_EQ(a.roll, b.roll) << tick;
    ASSERT_EQ(a.pitch, b.pitch) << tick;
    ASSERT_EQ(a.heading, b.heading) << tick;
  }
  EXPECT_GT(std::abs(plain.robot.attitude().angles().pitch), 500);
}

TEST(RobotImu, ACountThatTheOffsetWouldWrapStaysAsItIs) {
  Parameters parameters;
  parameters.accel_offset_x() = 1000;
  TestRobot corrected(parameters);
  TestRobot plain;
  for (TestRobot* robot : {&corrected, &plain}) {
    robot->sample.imu.accel()[0] = INT16_MIN + 10;  // less 1000 would be a large positive number
    robot->run(300);
  }
  EXPECT_EQ(corrected.robot.attitude().angles().pitch, plain.robot.attitude().angles().pitch);
}

TEST(RobotImu, OnlyANewMagnetometersSampleTurnsTheHeading) {
  TestRobot robot;
  robot.run(700);
  ASSERT_TRUE(robot.robot.attitude().ready());
  const Angle before = robot.robot.attitude().angles().heading;
  robot.sample.imu.mag()[0] = 1217;  // a quarter turn
  robot.sample.imu.mag()[1] = 0;
  for (int tick = 0; tick < 1000; ++tick) {
    robot.sample.time_us += kTickPeriod_us;
    robot.sample.fresh = kFreshGyro | kFreshAccel;
    robot.sample.imu.gyro()[0] = robot.sample.imu.gyro()[0] == 0 ? 1 : 0;
    robot.sample.radio_in_count = 0;
    robot.robot.tick(robot.sample, robot.output);
  }
  const auto turned = static_cast<Angle>(robot.robot.attitude().angles().heading - before);
  EXPECT_LT(std::abs(turned), 300);
  robot.run(2000);
  const auto now = static_cast<Angle>(robot.robot.attitude().angles().heading - before);
  EXPECT_GT(std::abs(now), 3000) << "it is believed again";
}

TEST(RobotImu, ARollOrPitchThatTheGyroFollowsIsSeenWhileItGoesOn) {
  // Faster than what the accelerometer is a witness in: the estimator alone tells.
  for (const int axis : {0, 1}) {
    TestRobot robot;
    robot.run(600);
    robot.send(robot.command(CommandOp::kArm));
    robot.run(4);
    ASSERT_EQ(robot.state(), RobotState::kArmed);
    constexpr double kRate_deg_per_s = 70.0;
    double angle = 0.0;
    while (angle < 90.0 && robot.state() == RobotState::kArmed) {
      angle += kRate_deg_per_s * 0.01;
      const double radians = angle * 3.14159265358979 / 180.0;
      robot.sample.time_us += kTickPeriod_us;
      robot.sample.radio_in_count = 0;
      const int noise = ++robot.ticks % 2;  // else it is a frozen gyro
      robot.sample.imu.gyro()[axis] = static_cast<int16_t>(kRate_deg_per_s / 0.07 + noise);
      robot.sample.imu.accel()[axis == 0 ? 1 : 0] =
          static_cast<int16_t>((axis == 0 ? 1.0 : -1.0) * 4098.0 * std::sin(radians));
      robot.sample.imu.accel()[2] = static_cast<int16_t>(4098.0 * std::cos(radians));
      robot.robot.tick(robot.sample, robot.output);
    }
    EXPECT_EQ(robot.robot.supervisor().faults(), Fault::kTilt) << axis;
    EXPECT_LT(angle, 70.0) << axis;
    EXPECT_GT(angle, 40.0) << axis;
  }
}

TEST(RobotImu, ARateThatStaysIsBiasOnlyWhileBothTracksRest) {
  // 7 counts are 0.49 degrees/s; which of the tracks moves does not matter.
  const auto turned = [](int left, int right) {
    TestRobot robot;
    robot.run(700);
    const Angle before = robot.robot.attitude().angles().heading;
    for (int tick = 0; tick < 2000; ++tick) {
      robot.sample.time_us += kTickPeriod_us;
      robot.sample.fresh = kFreshGyro | kFreshAccel;
      robot.sample.imu.gyro()[0] = robot.sample.imu.gyro()[0] == 0 ? 1 : 0;
      robot.sample.imu.gyro()[2] = 7;
      robot.sample.radio_in_count = 0;
      if (tick % 2 == 0) {
        robot.sample.encoder_left = static_cast<uint16_t>(robot.sample.encoder_left + left);
        robot.sample.encoder_right = static_cast<uint16_t>(robot.sample.encoder_right + right);
      }
      robot.robot.tick(robot.sample, robot.output);
    }
    const auto change = static_cast<Angle>(robot.robot.attitude().angles().heading - before);
    return change * 360.0 / 65536.0;
  };
  EXPECT_LT(std::abs(turned(0, 0)), 5.0);
  EXPECT_GT(turned(1, 0), 8.0);
  EXPECT_GT(turned(0, 1), 8.0);
  EXPECT_GT(turned(1, 1), 8.0);
}

// Faults of motors and encoders, with the whole robot in the loop: how long it takes until the
// motors have no power. docs/mcu-simulation.md lists them.

int ms_until_fault(TestRobot& robot) {
  int ticks = 0;
  for (; robot.state() != RobotState::kFault && ticks < 500; ++ticks) robot.tick();
  return 10 * ticks;
}

constexpr int16_t kSpeeds[] = {60, 100, 150, 200, 250, -60, -200};

// 22
TEST(DriveFaults, AnEncoderThatCountsTheWrongWayStopsTheRobot) {
  for (const int16_t speed : kSpeeds) {
    TestRobot robot = driving_robot(speed);
    robot.left_encoder_sign = -1;
    EXPECT_LE(ms_until_fault(robot), 280) << speed;
    EXPECT_EQ(robot.robot.supervisor().faults(), Fault::kMotorLeft) << speed;
    EXPECT_EQ(robot.output.duty_left, 0);
    EXPECT_EQ(robot.output.duty_right, 0);
  }
  // From the start on.
  TestRobot robot(drive_parameters());
  robot.left_encoder_sign = -1;
  robot.start();
  robot.send(robot.command(CommandOp::kDrive, {200, 0}));
  EXPECT_LE(ms_until_fault(robot), 350);
  EXPECT_LT(std::abs(robot.left.travel_mm), 40.0);
}

// 25
TEST(DriveFaults, ADriverThatIsStuckIsAFault) {
  for (const int16_t duty : std::initializer_list<int16_t>{400, -400, 200, -200}) {
    // Nobody asked for motion.
    TestRobot robot = driving_robot(0);
    robot.left_driver_stuck_at = duty;
    EXPECT_LE(ms_until_fault(robot), 350) << duty;
    EXPECT_EQ(robot.robot.supervisor().faults(), Fault::kMotorLeft) << duty;
    // The motors are to stop, or to turn the other way.
    for (const int16_t to : std::initializer_list<int16_t>{0, -150, -250}) {
      const int sign = duty > 0 ? 1 : -1;
      TestRobot moving = driving_robot(static_cast<int16_t>(150 * sign));
      moving.left_driver_stuck_at = duty;
      moving.send(moving.command(CommandOp::kDrive, {static_cast<int16_t>(to * sign), 0}));
      EXPECT_LE(ms_until_fault(moving), 900) << duty << " to " << to;
      EXPECT_NE(moving.robot.supervisor().faults() & Fault::kMotorLeft, 0) << duty << " to " << to;
    }
  }
}

// 24 and 21: 300 and 200 ms
TEST(DriveFaults, AStalledTrackAndADeadEncoderAreFoundAtLowSpeed) {
  for (const int16_t speed : kSpeeds) {
    TestRobot stalled = driving_robot(speed);
    stalled.left_blocked = true;
    stalled.left.speed_mm_per_s = 0.0;
    EXPECT_LE(ms_until_fault(stalled), 200) << speed;
    EXPECT_EQ(stalled.robot.supervisor().faults(), Fault::kStallLeft) << speed;
    TestRobot dead = driving_robot(speed);
    dead.right_encoder_dead = true;
    EXPECT_LE(ms_until_fault(dead), 200) << speed;
    EXPECT_EQ(dead.robot.supervisor().faults(), Fault::kStallRight) << speed;
  }
}

// Motors reverse, stop and start with a delay; that is no fault.
TEST(DriveFaults, AWellRobotMayReverseAsItLikes) {
  for (const int16_t accel_limit : std::initializer_list<int16_t>{50, 600, 2000, 5000}) {
    Parameters parameters = drive_parameters();
    parameters.accel_limit() = accel_limit;
    TestRobot robot(parameters);
    robot.start();
    for (const int16_t speed :
         std::initializer_list<int16_t>{250, -250, 0, 250, 0, -250, 250, 20, -20, 250, 60, 0}) {
      robot.send(robot.command(CommandOp::kDrive, {speed, 0}));
      robot.run(accel_limit < 600 ? 1100 : 150);
      ASSERT_EQ(robot.state(), RobotState::kRunning) << accel_limit << " to " << speed;
    }
    robot.send(robot.command(CommandOp::kDrive, {250, 0}));
    robot.run(200);
    robot.send(robot.command(CommandOp::kStop));
    robot.run(100);
    EXPECT_EQ(robot.state(), RobotState::kStopped);
  }
}

// The supervisor's witnesses of a track that does not move and of chips that fail.

TEST(TrackWatch, CountsStepToAndFroWithABrokenWire) {
  for (const int16_t duty : std::initializer_list<int16_t>{60, 240, -60, -400}) {
    TrackWatch watch;
    int ticks = 0;
    while (!watch.alternates() && ticks < 100) {
      watch.tick(duty, static_cast<int16_t>(ticks % 2 == 0 ? 1 : -1));
      ++ticks;
    }
    EXPECT_EQ(ticks, duty > 0 ? 5 : 4) << duty << ": forward the first step is progress";
  }
}

TEST(TrackWatch, BelowTheDutyOfAStallNothingIsCounted) {
  TrackWatch watch;
  for (int tick = 0; tick < 10; ++tick) watch.tick(109, 0);
  EXPECT_EQ(watch.still_ticks(), 0);
  for (int tick = 0; tick < 10; ++tick) watch.tick(110, 0);
  EXPECT_EQ(watch.still_ticks(), 10);
  watch.tick(-109, 0);
  EXPECT_EQ(watch.still_ticks(), 0);
}

TEST(TrackWatch, TwoCountsInATickAreProgressEitherWay) {
  for (const int16_t counts : std::initializer_list<int16_t>{2, -2, 3, -3, 40, -40}) {
    TrackWatch watch;
    for (int tick = 0; tick < 10; ++tick) watch.tick(300, 0);
    watch.tick(300, counts);
    EXPECT_EQ(watch.still_ticks(), 0) << counts;
  }
}

TEST(TrackWatch, TwoCountsInARowLeaveThePlaceOneDoesNotBackwards) {
  TrackWatch watch;
  for (int tick = 0; tick < 10; ++tick) watch.tick(300, 0);
  watch.tick(300, -1);
  EXPECT_EQ(watch.still_ticks(), 11) << "one count behind";
  watch.tick(300, -1);
  EXPECT_EQ(watch.still_ticks(), 0) << "two: it rolls back";
  watch.tick(300, -1);
  EXPECT_EQ(watch.still_ticks(), 1) << "the place is where it was seen last";
}

TEST(TrackWatch, StepsThatCancelWithinATickAreAStandstill) {
  TrackWatch watch;
  for (int tick = 0; tick < 18; ++tick) {
    const int16_t counts = tick == 0 || tick == 10 ? 1 : tick == 5 ? -1 : 0;
    watch.tick(300, counts);
  }
  EXPECT_EQ(watch.still_ticks(), 17) << "only the first step was progress";
}

TEST(TrackWatch, MotionEitherWayIsNeither) {
  for (const int16_t duty : std::initializer_list<int16_t>{60, 300, -300}) {
    for (const int16_t counts : std::initializer_list<int16_t>{1, 3, -1, -3}) {
      TrackWatch watch;
      for (int tick = 0; tick < 200; ++tick) {
        watch.tick(duty, tick % 4 == 0 ? counts : static_cast<int16_t>(0));
        EXPECT_FALSE(watch.alternates());
        EXPECT_LT(watch.still_ticks(), 18);
      }
    }
  }
}

TEST(TrackWatch, ATrackWithoutPowerMayRockAsItLikes) {
  TrackWatch watch;
  for (int tick = 0; tick < 200; ++tick)
    watch.tick(59, static_cast<int16_t>(tick % 2 == 0 ? 1 : -1));
  EXPECT_FALSE(watch.alternates());
  EXPECT_EQ(watch.still_ticks(), 0);
}

TEST(TrackWatch, GreatStepsDoNotOverflow) {
  TrackWatch watch;
  for (const int16_t counts : std::initializer_list<int16_t>{INT16_MIN, INT16_MAX, INT16_MIN}) {
    watch.tick(-kDutyMax, counts);
    watch.tick(400, counts);
  }
  EXPECT_FALSE(watch.alternates());
}

TEST(TrackWatch, ATrackThatMovesAgainstItsDutyDisobeys) {
  constexpr uint16_t kFullSpeed_mm_per_s = 250;
  struct Motion {
    int16_t duty;
    int16_t speed_dmm_per_s;
    int ticks;  ///< until it disobeys; 0: never
  };
  for (const Motion& it : std::initializer_list<Motion>{{240, -501, 12},
                                                        {-240, 501, 12},
                                                        {400, -2500, 12},
                                                        {0, 1001, 24},
                                                        {0, -1001, 24},
                                                        {59, 1001, 24},
                                                        {-239, 1001, 24},
                                                        {60, 1001, 0},
                                                        {0, 1000, 0},
                                                        {240, -500, 0},
                                                        {400, INT16_MAX, 0},
                                                        {400, INT16_MIN, 12}}) {
    TrackWatch watch;
    int ticks = 0;
    while (!watch.disobeys() && ticks < 300) {
      watch.compare(it.duty, it.speed_dmm_per_s, kFullSpeed_mm_per_s);
      ++ticks;
    }
    EXPECT_EQ(ticks, it.ticks == 0 ? 300 : it.ticks) << it.duty << " " << it.speed_dmm_per_s;
    // One tick in order ends it.
    watch.compare(300, 0, kFullSpeed_mm_per_s);
    EXPECT_FALSE(watch.disobeys());
  }
}

/// A tick of a healthy robot with these chips failing.
void tick(Supervisor& supervisor, uint8_t chips_failing, int number) {
  const int16_t gyro[3] = {static_cast<int16_t>(number % 2), 0, 0};
  const int16_t accel[3] = {0, 0, 4098};
  SupervisorInput input{};
  input.fresh = kFreshGyro | kFreshAccel;
  input.gyro = gyro;
  input.accel = accel;
  input.cos_tilt_q14 = 16384;
  input.estimator_ready = true;
  input.attitude_known = true;
  input.battery_mv = 7200;
  input.chips_failing = chips_failing;
  supervisor.heartbeat();
  supervisor.tick(Parameters(), input);
}

TEST(SupervisorChips, AFailingChipStopsTheRobotAndIsNamed) {
  for (const uint8_t chip : {ChipBit::kAccelMagChip, ChipBit::kGyroChip}) {
    Supervisor supervisor;
    for (int i = 0; i < 10; ++i) tick(supervisor, 0, i);
    ASSERT_EQ(supervisor.request(Request::kArm), RequestResult::kDone);
    ASSERT_EQ(supervisor.request(Request::kRun), RequestResult::kDone);
    for (int i = 0; i < 4; ++i) tick(supervisor, chip, i);
    EXPECT_TRUE(supervisor.running()) << "a hitch of the bus is no fault";
    tick(supervisor, chip, 5);
    EXPECT_EQ(supervisor.state(), RobotState::kFault);
    EXPECT_EQ(supervisor.faults(), chip << 8);
    // Latched; cleared once the chip is back.
    EXPECT_EQ(supervisor.request(Request::kClear), RequestResult::kFaultPresent);
    tick(supervisor, 0, 6);
    EXPECT_EQ(supervisor.request(Request::kClear), RequestResult::kDone);
  }
}

TEST(SupervisorChips, ARobotWithAFailingChipIsNotArmed) {
  Supervisor supervisor;
  for (int i = 0; i < 10; ++i) tick(supervisor, ChipBit::kGyroChip, i);
  EXPECT_EQ(supervisor.request(Request::kArm), RequestResult::kFaultPresent);
  EXPECT_EQ(supervisor.faults(), 0) << "nothing latched in a robot that nobody armed";
  EXPECT_EQ(supervisor.reported_faults(), Fault::kGyroChip) << "but the ground is told why";
}

TEST(SupervisorChips, ARobotDrivesWithoutItsBarometer) {
  Supervisor supervisor;
  for (int i = 0; i < 10; ++i) tick(supervisor, ChipBit::kBaroChip, i);
  EXPECT_EQ(supervisor.reported_faults(), 0);
  EXPECT_EQ(supervisor.request(Request::kArm), RequestResult::kDone);
  EXPECT_EQ(supervisor.request(Request::kRun), RequestResult::kDone);
  for (int i = 0; i < 10; ++i) tick(supervisor, ChipBit::kBaroChip, i);
  EXPECT_TRUE(supervisor.running());
}

}  // namespace

}  // namespace screed
