// The safe state machine: every request in every state, every fault with its deadline (ticks of 10
// ms), latch, clear, stand-alone.
#include "firmware/robot/supervisor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <numbers>

namespace screed {
namespace {

/// A supervisor with a robot that is well until a test says otherwise.
class Watch {
 public:
  explicit Watch(const Parameters& parameters = {}) : supervisor(parameters) {}

  /// One tick with the ground station heard.
  void tick() {
    if (heard) supervisor.heartbeat();
    silent_tick();
  }
  void silent_tick() {
    if (!gyro_frozen) gyro[2] = gyro[2] == 0 ? 1 : 0;  // the noise of its last digit
    const SupervisorInput input = {fresh,       gyro,         accel,     cos_tilt_q30,
                                   ready,       battery_mv,   duty_left, duty_right,
                                   counts_left, counts_right, 0,         stuck};
    supervisor.tick(input);
  }
  /// Ticks until the robot has left the state, at most `most`.
  int ticks_in(RobotState state, int most) {
    int ticks = 0;
    while (supervisor.state() == state && ticks < most) {
      tick();
      ++ticks;
    }
    return ticks;
  }
  void bring_to(RobotState state) {
    tick();
    if (state == RobotState::kDisarmed) return;
    if (state == RobotState::kFault) {
      supervisor.request(Request::kEmergencyStop);
      return;
    }
    supervisor.request(Request::kArm);
    if (state == RobotState::kArmed) return;
    supervisor.request(Request::kRun);
    if (state == RobotState::kStopped) supervisor.request(Request::kStop);
  }
  void roll_to(double degrees) {
    const double angle = degrees * std::numbers::pi / 180.0;
    accel[1] = static_cast<int16_t>(std::lround(4098.0 * std::sin(angle)));
    accel[2] = static_cast<int16_t>(std::lround(4098.0 * std::cos(angle)));
  }

  Supervisor supervisor;
  bool heard = true;
  uint8_t fresh = kFreshGyro | kFreshAccel;
  int16_t gyro[3] = {0, 0, 0};
  bool gyro_frozen = false;
  int16_t accel[3] = {0, 0, 4098};
  int32_t cos_tilt_q30 = kQ30One;
  bool ready = true;
  uint16_t battery_mv = 7200;
  int16_t duty_left = 0;
  int16_t duty_right = 0;
  int16_t counts_left = 0;
  int16_t counts_right = 0;
  bool stuck = false;
};

constexpr RobotState kAllStates[] = {RobotState::kDisarmed, RobotState::kArmed,
                                     RobotState::kRunning, RobotState::kStopped,
                                     RobotState::kFault};

// ---- requests

constexpr int kRobotStates = message::kHeartbeatStateMax + 1;

struct Transition {
  Request request;
  RobotState after[kRobotStates];  ///< from disarmed, armed, running, stopped, fault
  RequestResult result[kRobotStates];
};

TEST(Supervisor, EveryRequestInEveryState) {
  using enum message::HeartbeatState;  // clang takes no alias here
  constexpr RequestResult kOk = RequestResult::kDone;
  constexpr RequestResult kNo = RequestResult::kWrongState;
  const Transition table[] = {
      {Request::kArm, {kArmed, kArmed, kRunning, kStopped, kFault}, {kOk, kNo, kNo, kNo, kNo}},
      {Request::kRun, {kDisarmed, kRunning, kRunning, kRunning, kFault}, {kNo, kOk, kNo, kOk, kNo}},
      {Request::kStop, {kDisarmed, kArmed, kStopped, kStopped, kFault}, {kNo, kNo, kOk, kNo, kNo}},
      {Request::kDisarm,
       {kDisarmed, kDisarmed, kDisarmed, kDisarmed, kFault},
       {kOk, kOk, kOk, kOk, kNo}},
      {Request::kClear,
       {kDisarmed, kArmed, kRunning, kStopped, kDisarmed},
       {kNo, kNo, kNo, kNo, kOk}},
      {Request::kEmergencyStop,
       {kFault, kFault, kFault, kFault, kFault},
       {kOk, kOk, kOk, kOk, kOk}},
      {Request::kNone, {kDisarmed, kArmed, kRunning, kStopped, kFault}, {kNo, kNo, kNo, kNo, kNo}},
  };
  for (const Transition& row : table) {
    for (const RobotState state : kAllStates) {
      const auto i = static_cast<size_t>(state);
      Watch watch;
      watch.bring_to(state);
      ASSERT_EQ(watch.supervisor.state(), state);
      EXPECT_EQ(watch.supervisor.request(row.request), row.result[i])
          << static_cast<int>(row.request) << " in " << i;
      EXPECT_EQ(watch.supervisor.state(), row.after[i])
          << static_cast<int>(row.request) << " in " << i;
      EXPECT_EQ(watch.supervisor.faults() != 0, watch.supervisor.state() == kFault);
    }
  }
}

TEST(Supervisor, PowerOnlyWhileRunningOrStopping) {
  for (const RobotState state : kAllStates) {
    Watch watch;
    watch.bring_to(state);
    EXPECT_EQ(watch.supervisor.powered(),
              state == RobotState::kRunning || state == RobotState::kStopped);
    EXPECT_EQ(watch.supervisor.running(), state == RobotState::kRunning);
  }
}

TEST(Supervisor, ArmsOnlyWithAnAttitude) {
  Watch watch;
  watch.ready = false;
  watch.tick();
  EXPECT_EQ(watch.supervisor.request(Request::kArm), RequestResult::kNotReady);
  watch.ready = true;
  watch.tick();
  EXPECT_EQ(watch.supervisor.request(Request::kArm), RequestResult::kDone);
}

// ---- link: faults 1, 2, 12

TEST(SupervisorLink, LossStopsAfterHalfASecondAndDisarmsAfterOneAndAHalf) {
  Watch watch;
  watch.bring_to(RobotState::kRunning);
  watch.tick();  // the last heartbeat comes with this tick
  watch.heard = false;
  EXPECT_EQ(watch.ticks_in(RobotState::kRunning, 1000), 50);
  EXPECT_EQ(watch.supervisor.state(), RobotState::kStopped);
  EXPECT_TRUE(watch.supervisor.powered());  // to ramp down
  EXPECT_FALSE(watch.supervisor.link_alive());
  EXPECT_EQ(watch.ticks_in(RobotState::kStopped, 1000), 100);
  EXPECT_EQ(watch.supervisor.state(), RobotState::kDisarmed);
}

TEST(SupervisorLink, LossDisarmsAnArmedAndAStoppedRobot) {
  for (const RobotState state : {RobotState::kArmed, RobotState::kStopped}) {
    Watch watch;
    watch.bring_to(state);
    watch.tick();
    watch.heard = false;
    EXPECT_EQ(watch.ticks_in(state, 1000), 150);
    EXPECT_EQ(watch.supervisor.state(), RobotState::kDisarmed);
  }
}

TEST(SupervisorLink, AFlappingLinkNeitherArmsNorRuns) {
  for (const int period : {20, 60, 100, 200}) {
    Watch watch;
    watch.bring_to(RobotState::kRunning);
    bool stopped = false;
    for (int tick = 0; tick < 2000; ++tick) {
      watch.heard = (tick / period) % 2 == 1;
      watch.tick();
      stopped = stopped || !watch.supervisor.running();
      ASSERT_NE(stopped, watch.supervisor.running()) << period;
    }
    EXPECT_EQ(stopped, period > 50) << period;
  }
}

TEST(SupervisorLink, NeverHeardIsNotAlive) {
  Watch watch;
  watch.heard = false;
  watch.tick();
  EXPECT_FALSE(watch.supervisor.link_alive());
  watch.heard = true;
  watch.tick();
  EXPECT_TRUE(watch.supervisor.link_alive());
}

TEST(SupervisorLink, ALongSilenceDoesNotWrapRound) {
  Watch watch;
  watch.heard = false;
  for (int tick = 0; tick < 140000; ++tick) {
    watch.gyro[2] = static_cast<int16_t>(tick % 100);
    watch.silent_tick();
    ASSERT_FALSE(watch.supervisor.link_alive());
  }
}

// ---- faults with deadlines. Each is latched, stops a running robot, and cannot be cleared while
// its cause is there.

struct FaultCase {
  const char* name;
  uint16_t bit;
  int deadline_ticks;
  void (*begin)(Watch&);
};

const FaultCase kFaultCases[] = {
    // 27: stop within 100 ms
    {"tilt seen by the accelerometer", Fault::kTilt, 10, [](Watch& w) { w.roll_to(60.0); }},
    {"tilt seen by the estimator", Fault::kTilt, 10,
     [](Watch& w) {
       w.cos_tilt_q30 = static_cast<int32_t>(kQ30One * std::cos(60.0 * std::numbers::pi / 180.0));
     }},
    {"upside down", Fault::kTilt, 10, [](Watch& w) { w.roll_to(180.0); }},
    // 15: stop within 100 ms
    {"gyro silent", Fault::kImuSilent, 10, [](Watch& w) { w.fresh = kFreshAccel; }},
    {"accelerometer silent", Fault::kImuSilent, 10, [](Watch& w) { w.fresh = kFreshGyro; }},
    {"both silent", Fault::kImuSilent, 10, [](Watch& w) { w.fresh = 0; }},
    // 16: stop within 200 ms
    {"gyro frozen", Fault::kGyroFrozen, 20, [](Watch& w) { w.gyro_frozen = true; }},
    // 21: one encoder dead, 200 ms; 24: track stalled, 300 ms: the same to see
    {"left track stalled", Fault::kStallLeft, 20, [](Watch& w) { w.duty_left = 240; }},
    {"right track stalled backwards", Fault::kStallRight, 20,
     [](Watch& w) { w.duty_right = -400; }},
    // 30: a sag of a second
    {"battery", Fault::kBattery, 100, [](Watch& w) { w.battery_mv = 5999; }},
};

TEST(SupervisorFaults, StopWithinTheDeadlineAndStayLatched) {
  for (const FaultCase& fault : kFaultCases) {
    for (const RobotState state :
         {RobotState::kArmed, RobotState::kRunning, RobotState::kStopped}) {
      Watch watch;
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
      Watch well;
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
  constexpr int kTicks[] = {6, 6, 6, 8, 8, 8, 18, 17, 17, 100};  // of kFaultCases
  static_assert(std::size(kTicks) == std::size(kFaultCases));
  for (size_t i = 0; i < std::size(kTicks); ++i) {
    Watch watch;
    watch.bring_to(RobotState::kRunning);
    for (int tick = 0; tick < 10; ++tick) watch.tick();
    kFaultCases[i].begin(watch);
    EXPECT_EQ(watch.ticks_in(RobotState::kRunning, 1000), kTicks[i]) << kFaultCases[i].name;
  }
}

TEST(SupervisorFaults, ADipOfTheBatteryAtAStartIsNoFault) {
  Watch watch;
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
      Watch watch;
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
    Watch watch;
    fault.begin(watch);
    for (int tick = 0; tick < 150; ++tick) watch.tick();
    EXPECT_EQ(watch.supervisor.state(), RobotState::kDisarmed) << fault.name;
    EXPECT_EQ(watch.supervisor.request(Request::kArm), RequestResult::kFaultPresent) << fault.name;
  }
}

TEST(SupervisorFaults, AnEncoderThatStepsToAndFroIsNamed) {
  for (const bool left : {true, false}) {
    Watch watch;
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
    Watch watch;
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
    Watch watch;
    watch.bring_to(RobotState::kRunning);
    watch.accel[1] = c.accel;
    watch.accel[2] = 0;
    watch.gyro[0] = c.gyro;
    EXPECT_EQ(watch.ticks_in(RobotState::kRunning, 10) < 10, c.tilted) << c.accel << " " << c.gyro;
  }
}

TEST(SupervisorFaults, TheEstimatorsInclinationIsComparedWithTheLimitItself) {
  Parameters parameters;
  parameters.tilt_limit = 6000;
  for (const double degrees : {59.9, 60.1}) {
    Watch watch(parameters);
    watch.bring_to(RobotState::kRunning);
    watch.cos_tilt_q30 =
        static_cast<int32_t>(kQ30One * std::cos(degrees * std::numbers::pi / 180.0));
    EXPECT_EQ(watch.ticks_in(RobotState::kRunning, 300) == 300, degrees < 60.0) << degrees;
  }
}

TEST(SupervisorLink, IsAliveForHalfASecond) {
  Watch watch;
  watch.tick();
  watch.heard = false;
  for (int tick = 1; tick < 50; ++tick) watch.tick();
  EXPECT_TRUE(watch.supervisor.link_alive());
  EXPECT_EQ(watch.supervisor.request(Request::kArm), RequestResult::kDone);
  watch.tick();
  EXPECT_FALSE(watch.supervisor.link_alive());
}

TEST(SupervisorFaults, SeveralCausesAreAllTold) {
  Watch watch;
  watch.bring_to(RobotState::kRunning);
  watch.fresh = 0;
  watch.roll_to(90.0);
  for (int tick = 0; tick < 20; ++tick) watch.tick();
  EXPECT_EQ(watch.supervisor.faults(), Fault::kTilt | Fault::kImuSilent);
}

TEST(SupervisorFaults, EmergencyStopIsClearedByHandOnly) {
  Watch watch;
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
  parameters.spin_rate = 1;
  Watch watch(parameters);
  watch.tick();
  EXPECT_EQ(watch.supervisor.request(Request::kArm), RequestResult::kFaultPresent);
}

// ---- what is no fault

TEST(SupervisorFaults, AnInclinationBelowTheLimitIsAllowed) {
  for (const double degrees : {-49.0, 30.0, 49.0}) {
    Watch watch;
    watch.bring_to(RobotState::kRunning);
    watch.roll_to(degrees);
    EXPECT_EQ(watch.ticks_in(RobotState::kRunning, 300), 300) << degrees;
  }
  for (const double degrees : {-51.0, 51.0}) {
    Watch watch;
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
    Watch watch;
    watch.bring_to(RobotState::kRunning);
    watch.accel[0] = force.x;
    watch.accel[2] = force.z;
    watch.gyro[0] = force.rate;
    EXPECT_EQ(watch.ticks_in(RobotState::kRunning, 300), 300) << force.x << " " << force.rate;
    // The estimator is.
    watch.cos_tilt_q30 = 0;
    EXPECT_LE(watch.ticks_in(RobotState::kRunning, 300), 10);
  }
}

TEST(SupervisorFaults, ClippedSamplesDoNotOverflow) {
  for (const int16_t x : std::initializer_list<int16_t>{INT16_MIN, INT16_MAX}) {
    for (const int16_t z : std::initializer_list<int16_t>{INT16_MIN, INT16_MAX}) {
      Watch watch;
      watch.bring_to(RobotState::kRunning);
      watch.accel[0] = x;
      watch.accel[1] = x;
      watch.accel[2] = z;
      watch.cos_tilt_q30 = INT32_MIN;
      EXPECT_LE(watch.ticks_in(RobotState::kRunning, 300), 10);
    }
  }
}

TEST(SupervisorFaults, ShortTroubleIsForgiven) {
  for (const FaultCase& fault : kFaultCases) {
    Watch watch;
    watch.bring_to(RobotState::kRunning);
    for (int round = 0; round < 50; ++round) {
      Watch bad = watch;
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
  Watch watch;
  watch.bring_to(RobotState::kRunning);
  for (int tick = 0; tick < 400; ++tick) {
    watch.gyro_frozen = tick % 2 == 0;
    watch.fresh = tick % 2 == 0 ? kFreshAccel : kFreshGyro | kFreshAccel;
    watch.tick();
  }
  EXPECT_EQ(watch.supervisor.state(), RobotState::kRunning);
}

TEST(SupervisorFaults, SlowOrWeaklyDrivenTracksAreNotStalled) {
  Watch weak;
  weak.bring_to(RobotState::kRunning);
  weak.duty_left = 239;
  weak.duty_right = -239;
  EXPECT_EQ(weak.ticks_in(RobotState::kRunning, 500), 500);
  Watch slow;
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
  parameters.battery_low = 0;
  Watch watch(parameters);
  watch.bring_to(RobotState::kRunning);
  watch.battery_mv = 0;
  EXPECT_EQ(watch.ticks_in(RobotState::kRunning, 500), 500);
}

// ---- stand-alone

Parameters standalone_parameters() {
  Parameters parameters;
  parameters.standalone = 1;
  parameters.standalone_delay = 3000;
  return parameters;
}

TEST(SupervisorStandalone, RunsAfterTheDelayWithoutAGroundStation) {
  Watch watch(standalone_parameters());
  watch.heard = false;
  EXPECT_EQ(watch.ticks_in(RobotState::kDisarmed, 1000), 301);
  EXPECT_EQ(watch.supervisor.state(), RobotState::kRunning);
  EXPECT_EQ(watch.ticks_in(RobotState::kRunning, 1000), 1000);  // no link, no loss
}

TEST(SupervisorStandalone, WaitsForTheAttitudeAndForFaultsToGo) {
  Watch watch(standalone_parameters());
  watch.heard = false;
  watch.ready = false;
  EXPECT_EQ(watch.ticks_in(RobotState::kDisarmed, 600), 600);
  watch.ready = true;
  watch.roll_to(90.0);
  EXPECT_EQ(watch.ticks_in(RobotState::kDisarmed, 600), 1);  // tilt takes its 60 ms to be seen
}

TEST(SupervisorStandalone, OnceStoppedItStaysStopped) {
  for (const Request request : {Request::kStop, Request::kDisarm, Request::kEmergencyStop}) {
    for (const int ticks_before : {1, 100, 500}) {  // before and after the start
      Watch watch(standalone_parameters());
      watch.heard = false;
      for (int tick = 0; tick < ticks_before; ++tick) watch.tick();
      watch.supervisor.request(request);
      for (int tick = 0; tick < 1000; ++tick) {
        watch.supervisor.request(Request::kClear);
        watch.tick();
        ASSERT_FALSE(watch.supervisor.running())
            << static_cast<int>(request) << " " << ticks_before;
      }
    }
  }
}

TEST(SupervisorStandalone, AFaultEndsItForGood) {
  Watch watch(standalone_parameters());
  watch.heard = false;
  watch.ticks_in(RobotState::kDisarmed, 1000);
  watch.roll_to(120.0);
  for (int tick = 0; tick < 20; ++tick) watch.tick();
  watch.roll_to(0.0);
  for (int tick = 0; tick < 20; ++tick) watch.tick();
  EXPECT_EQ(watch.supervisor.request(Request::kClear), RequestResult::kDone);
  EXPECT_EQ(watch.ticks_in(RobotState::kDisarmed, 1000), 1000);
}

TEST(Supervisor, StopsARobotThatIsStuckForTooLong) {
  Parameters parameters;
  parameters.stuck_time = 2000;
  Watch watch(parameters);
  watch.bring_to(RobotState::kRunning);
  watch.stuck = true;
  for (int tick = 0; tick < 150; ++tick) watch.tick();
  watch.stuck = false;  // it came free
  watch.tick();
  watch.stuck = true;
  EXPECT_EQ(watch.ticks_in(RobotState::kRunning, 1000), 200);
  EXPECT_EQ(watch.supervisor.faults(), Fault::kStuck);
}

TEST(Supervisor, OnlyTellsOfAStuckRobotByDefault) {
  Watch watch;
  watch.bring_to(RobotState::kRunning);
  watch.stuck = true;
  EXPECT_EQ(watch.ticks_in(RobotState::kRunning, 6000), 6000);
}

TEST(SupervisorStandalone, OffByDefault) {
  Watch watch;
  EXPECT_EQ(watch.ticks_in(RobotState::kDisarmed, 1000), 1000);
}

}  // namespace
}  // namespace screed
