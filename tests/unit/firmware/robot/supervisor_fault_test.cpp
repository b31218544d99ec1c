// What the supervisor takes for a fault and what not: every fault with its deadline (ticks of 10
// ms), latch, clear.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/unit/firmware/robot/supervised_robot.h"

namespace screed {
namespace {

// ---- what is reported

TEST(Supervisor, PresentCausesAreReportedUntilAFaultIsLatched) {
  SupervisedRobot watch;
  watch.battery_mv = 5000;
  for (int i = 0; i < 200; ++i) watch.tick();
  EXPECT_EQ(watch.supervisor.state(), RobotState::kDisarmed);
  EXPECT_EQ(watch.supervisor.reported_faults(), Fault::kBattery);
  watch.battery_mv = 7200;
  watch.tick();
  EXPECT_EQ(watch.supervisor.reported_faults(), 0) << "gone with its cause";

  watch.bring_to(RobotState::kRunning);
  EXPECT_EQ(watch.supervisor.reported_faults(), 0);
  watch.battery_mv = 5000;
  for (int i = 0; i < 200; ++i) watch.tick();
  ASSERT_EQ(watch.supervisor.state(), RobotState::kFault);
  watch.battery_mv = 7200;
  watch.tick();
  EXPECT_EQ(watch.supervisor.present_faults(), 0);
  EXPECT_EQ(watch.supervisor.reported_faults(), Fault::kBattery) << "latched";
}

// ---- faults with deadlines. Each is latched, stops a running robot, and cannot be cleared while
// its cause is there.

struct FaultCase {
  const char* name;
  uint16_t bit;
  int deadline_ticks;
  int ticks;  ///< what it takes today
  void (*begin)(SupervisedRobot&);
};

const FaultCase kFaultCases[] = {
    // 27: stop within 100 ms
    {"tilt seen by the accelerometer", Fault::kTilt, 10, 6,
     [](SupervisedRobot& w) { w.roll_to(60.0); }},
    {"tilt seen by the estimator", Fault::kTilt, 10, 6,
     [](SupervisedRobot& w) {
       w.cos_tilt_q14 = static_cast<int16_t>(16384 * std::cos(60.0 * std::numbers::pi / 180.0));
     }},
    {"upside down", Fault::kTilt, 10, 6, [](SupervisedRobot& w) { w.roll_to(180.0); }},
    // 15: stop within 100 ms
    {"gyro silent", Fault::kImuSilent, 10, 8, [](SupervisedRobot& w) { w.fresh = kFreshAccel; }},
    {"accelerometer silent", Fault::kImuSilent, 10, 8,
     [](SupervisedRobot& w) { w.fresh = kFreshGyro; }},
    {"both silent", Fault::kImuSilent, 10, 8, [](SupervisedRobot& w) { w.fresh = 0; }},
    // 16: stop within 200 ms
    {"gyro frozen", Fault::kGyroFrozen, 20, 18, [](SupervisedRobot& w) { w.gyro_frozen = true; }},
    // 21: one encoder dead, 200 ms; 24: track stalled, 300 ms: the same to see
    {"left track stalled", Fault::kStallLeft, 20, 15,
     [](SupervisedRobot& w) { w.duty_left = 110; }},
    {"right track stalled backwards", Fault::kStallRight, 20, 15,
     [](SupervisedRobot& w) { w.duty_right = -400; }},
    // 30: a sag of a second
    {"battery", Fault::kBattery, 100, 100, [](SupervisedRobot& w) { w.battery_mv = 5999; }},
};

TEST(SupervisorFaults, StopWithinTheDeadlineAndStayLatched) {
  for (const FaultCase& fault : kFaultCases) {
    for (const RobotState state :
         {RobotState::kArmed, RobotState::kRunning, RobotState::kStopped}) {
      SupervisedRobot watch;
      watch.bring_to(state);
      for (int tick = 0; tick < 500; ++tick) watch.tick();
      ASSERT_EQ(watch.supervisor.state(), state) << fault.name;
      fault.begin(watch);
      const int ticks = watch.ticks_in(state, 1000);
      EXPECT_LE(ticks, fault.deadline_ticks) << fault.name;
      EXPECT_GE(ticks, 5) << fault.name << ": a single bad sample is no fault";
      ASSERT_EQ(watch.supervisor.state(), RobotState::kFault) << fault.name;
      EXPECT_FALSE(watch.supervisor.powered());
      EXPECT_EQ(watch.supervisor.faults(), fault.bit) << fault.name;
      EXPECT_EQ(watch.supervisor.request(Request::kClear), RequestResult::kFaultPresent)
          << fault.name;

      // The cause goes: still latched until it is cleared, and then disarmed.
      const Supervisor kept = watch.supervisor;
      SupervisedRobot well;
      well.supervisor = kept;
      for (int tick = 0; tick < 10; ++tick) well.tick();
      EXPECT_EQ(well.supervisor.faults(), fault.bit) << fault.name;
      EXPECT_EQ(well.supervisor.request(Request::kArm), RequestResult::kWrongState);
      EXPECT_EQ(well.supervisor.request(Request::kRun), RequestResult::kWrongState);
      EXPECT_EQ(well.supervisor.request(Request::kClear), RequestResult::kDone) << fault.name;
      EXPECT_EQ(well.supervisor.state(), RobotState::kDisarmed);
      EXPECT_EQ(well.supervisor.faults(), 0);
    }
  }
}

TEST(SupervisorFaults, AreTakenForRealAfterTheirNumberOfTicks) {
  for (const FaultCase& fault : kFaultCases) {
    SupervisedRobot watch;
    watch.bring_to(RobotState::kRunning);
    for (int tick = 0; tick < 10; ++tick) watch.tick();
    fault.begin(watch);
    EXPECT_EQ(watch.ticks_in(RobotState::kRunning, 1000), fault.ticks) << fault.name;
  }
}

TEST(SupervisorFaults, ADipOfTheBatteryAtAStartIsNoFault) {
  SupervisedRobot watch;
  watch.bring_to(RobotState::kRunning);
  for (int dip = 0; dip < 3; ++dip) {
    watch.battery_mv = 5000;
    EXPECT_EQ(watch.ticks_in(RobotState::kRunning, 99), 99);
    EXPECT_EQ(watch.supervisor.state(), RobotState::kRunning);
    watch.battery_mv = 6000;  // at the limit it is not low
    watch.tick();
  }
  EXPECT_EQ(watch.ticks_in(RobotState::kRunning, 500), 500);
}

TEST(SupervisorFaults, TheAccelerometerIsAWitnessAtRestAndBetweenFourAndSixFifthsOfG) {
  // A robot on its side, by the force that it feels in g and its rate of turn in degrees/s.
  struct Case {
    double g;
    double rate;
    bool tilted;
  };
  for (const Case c : {Case{0.79, 0.0, false}, Case{0.81, 0.0, true}, Case{1.19, 0.0, true},
                       Case{1.21, 0.0, false}, Case{1.0, 56.5, true}, Case{1.0, 57.5, false},
                       Case{1.0, -56.5, true}, Case{1.0, -57.5, false}}) {
    for (int axis = 0; axis < 3; ++axis) {
      SupervisedRobot watch;
      watch.bring_to(RobotState::kRunning);
      watch.accel[1] = static_cast<int16_t>(std::lround(4098.0 * c.g));
      watch.accel[2] = 0;
      watch.gyro_frozen = axis == 2;  // its last axis is the test's
      watch.gyro[axis] = static_cast<int16_t>(std::lround(c.rate / 0.07));
      EXPECT_EQ(watch.ticks_in(RobotState::kRunning, 10) < 10, c.tilted)
          << c.g << " g, " << c.rate << " degrees/s about " << axis;
    }
  }
}

TEST(SupervisorFaults, KeepADisarmedRobotFromBeingArmed) {  // 14 among them
  for (const FaultCase& fault : kFaultCases) {
    SupervisedRobot watch;
    fault.begin(watch);
    for (int tick = 0; tick < 150; ++tick) watch.tick();
    EXPECT_EQ(watch.supervisor.state(), RobotState::kDisarmed) << fault.name;
    EXPECT_EQ(watch.supervisor.request(Request::kArm), RequestResult::kFaultPresent) << fault.name;
  }
}

TEST(SupervisorFaults, AnEncoderThatStepsToAndFroIsNamed) {
  for (const bool left : {true, false}) {
    SupervisedRobot watch;
    watch.bring_to(RobotState::kRunning);
    watch.duty_left = watch.duty_right = 100;
    for (int tick = 0; tick < 10; ++tick) {
      const auto broken = static_cast<int16_t>(tick % 2 == 0 ? 1 : -1);
      watch.counts_left = left ? broken : static_cast<int16_t>(3);
      watch.counts_right = left ? static_cast<int16_t>(3) : broken;
      watch.tick();
    }
    EXPECT_EQ(watch.supervisor.state(), RobotState::kFault);
    EXPECT_EQ(watch.supervisor.faults(), left ? Fault::kEncoderLeft : Fault::kEncoderRight);
  }
}

TEST(SupervisorFaults, ACauseThatStaysIsPresentForAsLongAsItStays) {
  for (const FaultCase& fault : kFaultCases) {
    SupervisedRobot watch;
    watch.bring_to(RobotState::kRunning);
    for (int tick = 0; tick < 10; ++tick) watch.tick();
    fault.begin(watch);
    for (int tick = 0; tick < 110; ++tick) watch.tick();
    for (int tick = 0; tick < 600; ++tick) {
      watch.tick();
      ASSERT_EQ(watch.supervisor.present_faults(), fault.bit) << fault.name << ", tick " << tick;
    }
  }
}

TEST(SupervisorFaults, LimitsOfTheAccelerometerAsAWitnessAreIncluded) {
  // Counts of the raw sensors: 819 and 1229 quarters of the accelerometer, 814 of the gyro.
  struct Case {
    int16_t accel;
    int16_t gyro;
    bool tilted;
  };
  for (const Case c : {Case{4 * 819, 0, true}, Case{4 * 818, 0, false}, Case{4 * 1229, 0, true},
                       Case{4 * 1230, 0, false}, Case{4098, 814, true}, Case{4098, 815, false},
                       Case{4098, -814, true}, Case{4098, -815, false}}) {
    SupervisedRobot watch;
    watch.bring_to(RobotState::kRunning);
    watch.accel[1] = c.accel;
    watch.accel[2] = 0;
    watch.gyro[0] = c.gyro;
    EXPECT_EQ(watch.ticks_in(RobotState::kRunning, 10) < 10, c.tilted) << c.accel << " " << c.gyro;
  }
}

// Tracks that slip to and fro brake the robot so evenly that the force stands slanting for a while.
// An estimator that knows the attitude then is the only witness.
TEST(SupervisorFaults, TheAccelerometerIsNoWitnessOfTiltWhileTheTracksSlipOnPurpose) {
  struct Case {
    bool slips, known, tilted;
  };
  for (const Case c : {Case{false, true, true}, Case{true, true, false}, Case{true, false, true}}) {
    SupervisedRobot watch;
    watch.bring_to(RobotState::kRunning);
    watch.slips_on_purpose = c.slips;
    watch.attitude_known = c.known;
    watch.roll_to(60.0);
    EXPECT_EQ(watch.ticks_in(RobotState::kRunning, 10) < 10, c.tilted) << c.slips << " " << c.known;
    watch.attitude_known = true;
    watch.cos_tilt_q14 = 0;
    EXPECT_LT(watch.ticks_in(RobotState::kRunning, 10), 10) << "the estimator says so";
  }
}

TEST(SupervisorFaults, TheEstimatorsInclinationIsComparedWithTheLimitItself) {
  Parameters parameters;
  parameters.tilt_limit() = 6000;
  for (const double degrees : {59.9, 60.1}) {
    SupervisedRobot watch(parameters);
    watch.bring_to(RobotState::kRunning);
    watch.cos_tilt_q14 = static_cast<int16_t>(16384 * std::cos(degrees * std::numbers::pi / 180.0));
    EXPECT_EQ(watch.ticks_in(RobotState::kRunning, 300) == 300, degrees < 60.0) << degrees;
  }
}

// The estimator averages anew in the first standstill; until then it knows roll and pitch as
// before.
TEST(SupervisorFaults, AnEstimatorThatAveragesAnewRemainsAWitnessOfTilt) {
  SupervisedRobot watch;
  watch.bring_to(RobotState::kRunning);
  watch.ready = false;
  watch.gyro[1] = 2000;  // the accelerometer is no plumb line while the robot rolls
  watch.cos_tilt_q14 = 0;
  EXPECT_LE(watch.ticks_in(RobotState::kRunning, 300), 10);
  EXPECT_EQ(watch.supervisor.faults(), Fault::kTilt);
}

TEST(SupervisorFaults, SeveralCausesAreAllTold) {
  SupervisedRobot watch;
  watch.bring_to(RobotState::kRunning);
  watch.fresh = 0;
  watch.roll_to(90.0);
  for (int tick = 0; tick < 20; ++tick) watch.tick();
  EXPECT_EQ(watch.supervisor.faults(), Fault::kTilt | Fault::kImuSilent);
}

TEST(SupervisorFaults, EmergencyStopIsClearedByHandOnly) {
  SupervisedRobot watch;
  watch.bring_to(RobotState::kRunning);
  watch.supervisor.request(Request::kEmergencyStop);
  EXPECT_EQ(watch.supervisor.faults(), Fault::kEmergencyStop);
  for (int tick = 0; tick < 100; ++tick) watch.tick();
  EXPECT_EQ(watch.supervisor.state(), RobotState::kFault);
  watch.heard = false;
  for (int tick = 0; tick < 300; ++tick) watch.tick();
  EXPECT_EQ(watch.supervisor.state(), RobotState::kFault);  // link loss does not unlatch it
}

TEST(SupervisorFaults, ParametersOutOfRangeRefuseToArm) {
  Parameters parameters;
  parameters.spin_rate() = 1;
  SupervisedRobot watch(parameters);
  watch.tick();
  EXPECT_EQ(watch.supervisor.request(Request::kArm), RequestResult::kFaultPresent);
}

// ---- what is no fault

TEST(SupervisorFaults, AnInclinationBelowTheLimitIsAllowed) {
  for (const double degrees : {-49.0, 30.0, 49.0}) {
    SupervisedRobot watch;
    watch.bring_to(RobotState::kRunning);
    watch.roll_to(degrees);
    EXPECT_EQ(watch.ticks_in(RobotState::kRunning, 300), 300) << degrees;
  }
  for (const double degrees : {-51.0, 51.0}) {
    SupervisedRobot watch;
    watch.bring_to(RobotState::kRunning);
    watch.roll_to(degrees);
    EXPECT_LE(watch.ticks_in(RobotState::kRunning, 300), 10) << degrees;
  }
}

TEST(SupervisorFaults, InMotionTheAccelerometerAloneIsNoWitness) {
  // Tipping over a crest: the force points anywhere, is short, or long, or the robot turns.
  struct Force {
    int16_t x;
    int16_t z;
    int16_t rate;
  };
  for (const Force force : {Force{300, 100, 0}, Force{INT16_MIN, 0, 0}, Force{4098, 0, 3000},
                            Force{4098, 0, INT16_MIN}}) {
    SupervisedRobot watch;
    watch.bring_to(RobotState::kRunning);
    watch.accel[0] = force.x;
    watch.accel[2] = force.z;
    watch.gyro[0] = force.rate;
    EXPECT_EQ(watch.ticks_in(RobotState::kRunning, 300), 300) << force.x << " " << force.rate;
    // The estimator is.
    watch.cos_tilt_q14 = 0;
    EXPECT_LE(watch.ticks_in(RobotState::kRunning, 300), 10);
  }
}

TEST(SupervisorFaults, ClippedSamplesDoNotOverflow) {
  for (const int16_t x : std::initializer_list<int16_t>{INT16_MIN, INT16_MAX}) {
    for (const int16_t z : std::initializer_list<int16_t>{INT16_MIN, INT16_MAX}) {
      SupervisedRobot watch;
      watch.bring_to(RobotState::kRunning);
      watch.accel[0] = x;
      watch.accel[1] = x;
      watch.accel[2] = z;
      watch.cos_tilt_q14 = INT16_MIN;
      EXPECT_LE(watch.ticks_in(RobotState::kRunning, 300), 10);
    }
  }
}

TEST(SupervisorFaults, ShortTroubleIsForgiven) {
  for (const FaultCase& fault : kFaultCases) {
    SupervisedRobot watch;
    watch.bring_to(RobotState::kRunning);
    for (int round = 0; round < 50; ++round) {
      SupervisedRobot bad = watch;
      fault.begin(bad);
      for (int tick = 0; tick < 4; ++tick) bad.tick();
      watch.supervisor = bad.supervisor;
      watch.gyro[2] = bad.gyro[2];
      watch.tick();
    }
    EXPECT_EQ(watch.supervisor.state(), RobotState::kRunning) << fault.name;
  }
}

TEST(SupervisorFaults, AGyroSlowerThanTheTickIsNotFrozen) {
  // New values in every second tick only, and their numbers change.
  SupervisedRobot watch;
  watch.bring_to(RobotState::kRunning);
  for (int tick = 0; tick < 400; ++tick) {
    watch.gyro_frozen = tick % 2 == 0;
    watch.fresh = tick % 2 == 0 ? kFreshAccel : kFreshGyro | kFreshAccel;
    watch.tick();
  }
  EXPECT_EQ(watch.supervisor.state(), RobotState::kRunning);
}

TEST(SupervisorFaults, AFrozenGyroIsCountedInSamplesNotInTicks) {
  SupervisedRobot watch;
  watch.bring_to(RobotState::kRunning);
  watch.gyro_frozen = true;
  // A sample in four ticks: the same 17 times, which is 68 ticks, and another one then.
  for (int round = 0; round < 5; ++round) {
    for (int tick = 0; tick < 4 * 17; ++tick) {
      watch.fresh = tick % 4 == 0 ? kFreshGyro | kFreshAccel : kFreshAccel;
      watch.tick();
      ASSERT_EQ(watch.supervisor.state(), RobotState::kRunning) << round << ", " << tick;
    }
    watch.gyro[2] = watch.gyro[2] == 0 ? 1 : 0;
  }
}

TEST(SupervisorFaults, SlowOrWeaklyDrivenTracksAreNotStalled) {
  SupervisedRobot weak;
  weak.bring_to(RobotState::kRunning);
  weak.duty_left = 109;
  weak.duty_right = -109;
  EXPECT_EQ(weak.ticks_in(RobotState::kRunning, 500), 500);
  SupervisedRobot slow;
  slow.bring_to(RobotState::kRunning);
  slow.duty_left = 400;
  for (int tick = 0; tick < 500; ++tick) {  // one count in 0.1 s: 6 mm/s
    slow.counts_left = tick % 10 == 0 ? 1 : 0;
    slow.tick();
  }
  EXPECT_EQ(slow.supervisor.state(), RobotState::kRunning);
}

TEST(SupervisorFaults, BatteryWatchCanBeSwitchedOff) {
  Parameters parameters;
  parameters.battery_low() = 0;
  SupervisedRobot watch(parameters);
  watch.bring_to(RobotState::kRunning);
  watch.battery_mv = 0;
  EXPECT_EQ(watch.ticks_in(RobotState::kRunning, 500), 500);
}

}  // namespace
}  // namespace screed
