// The safe state machine: every request in every state, the link, stand-alone, a stuck robot.
#include <gtest/gtest.h>

#include <initializer_list>

#include "tests/unit/firmware/robot/supervised_robot.h"

namespace screed {
namespace {

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
      SupervisedRobot watch;
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
    SupervisedRobot watch;
    watch.bring_to(state);
    EXPECT_EQ(watch.supervisor.powered(),
              state == RobotState::kRunning || state == RobotState::kStopped);
    EXPECT_EQ(watch.supervisor.running(), state == RobotState::kRunning);
  }
}

TEST(Supervisor, ArmsOnlyWithAnAttitude) {
  SupervisedRobot watch;
  watch.ready = false;
  watch.tick();
  EXPECT_EQ(watch.supervisor.request(Request::kArm), RequestResult::kNotReady);
  watch.ready = true;
  watch.tick();
  EXPECT_EQ(watch.supervisor.request(Request::kArm), RequestResult::kDone);
}

// ---- link: faults 1, 2, 12

TEST(SupervisorLink, LossStopsAfterHalfASecondAndDisarmsAfterOneAndAHalf) {
  SupervisedRobot watch;
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
    SupervisedRobot watch;
    watch.bring_to(state);
    watch.tick();
    watch.heard = false;
    EXPECT_EQ(watch.ticks_in(state, 1000), 150);
    EXPECT_EQ(watch.supervisor.state(), RobotState::kDisarmed);
  }
}

TEST(SupervisorLink, AFlappingLinkNeitherArmsNorRuns) {
  for (const int period : {20, 60, 100, 200}) {
    SupervisedRobot watch;
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
  SupervisedRobot watch;
  watch.heard = false;
  watch.tick();
  EXPECT_FALSE(watch.supervisor.link_alive());
  watch.heard = true;
  watch.tick();
  EXPECT_TRUE(watch.supervisor.link_alive());
}

TEST(SupervisorLink, ALongSilenceDoesNotWrapRound) {
  SupervisedRobot watch;
  watch.heard = false;
  for (int tick = 0; tick < 140000; ++tick) {
    watch.gyro[2] = static_cast<int16_t>(tick % 100);
    watch.silent_tick();
    ASSERT_FALSE(watch.supervisor.link_alive());
  }
}

TEST(SupervisorLink, IsAliveForHalfASecond) {
  SupervisedRobot watch;
  watch.tick();
  watch.heard = false;
  for (int tick = 1; tick < 50; ++tick) watch.tick();
  EXPECT_TRUE(watch.supervisor.link_alive());
  EXPECT_EQ(watch.supervisor.request(Request::kArm), RequestResult::kDone);
  watch.tick();
  EXPECT_FALSE(watch.supervisor.link_alive());
}

// ---- stand-alone

Parameters standalone_parameters() {
  Parameters parameters;
  parameters.standalone() = 1;
  parameters.standalone_delay() = 3000;
  return parameters;
}

TEST(SupervisorStandalone, RunsAfterTheDelayWithoutAGroundStation) {
  SupervisedRobot watch(standalone_parameters());
  watch.heard = false;
  EXPECT_EQ(watch.ticks_in(RobotState::kDisarmed, 1000), 301);
  EXPECT_EQ(watch.supervisor.state(), RobotState::kRunning);
  EXPECT_EQ(watch.ticks_in(RobotState::kRunning, 1000), 1000);  // no link, no loss
}

TEST(SupervisorStandalone, WaitsForTheAttitudeAndForFaultsToGo) {
  SupervisedRobot watch(standalone_parameters());
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
      SupervisedRobot watch(standalone_parameters());
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
  SupervisedRobot watch(standalone_parameters());
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
  parameters.stuck_time() = 2000;
  SupervisedRobot watch(parameters);
  watch.bring_to(RobotState::kRunning);
  watch.stuck = true;
  for (int tick = 0; tick < 150; ++tick) watch.tick();
  watch.stuck = false;  // it came free
  watch.tick();
  watch.stuck = true;
  EXPECT_EQ(watch.ticks_in(RobotState::kRunning, 1000), 200);
  EXPECT_EQ(watch.supervisor.faults(), Fault::kStuck);
}

TEST(Supervisor, HoldsARobotWhoseEscapeDidNotHelp) {
  SupervisedRobot watch;
  watch.bring_to(RobotState::kRunning);
  watch.stuck = true;
  watch.tick();
  ASSERT_EQ(watch.supervisor.state(), RobotState::kRunning);
  watch.gave_up = true;
  watch.tick();
  EXPECT_EQ(watch.supervisor.state(), RobotState::kFault);
  EXPECT_EQ(watch.supervisor.faults(), Fault::kStuck);
}

TEST(Supervisor, OnlyTellsOfAStuckRobotByDefault) {
  SupervisedRobot watch;
  watch.bring_to(RobotState::kRunning);
  watch.stuck = true;
  EXPECT_EQ(watch.ticks_in(RobotState::kRunning, 6000), 6000);
}

TEST(SupervisorStandalone, OffByDefault) {
  SupervisedRobot watch;
  EXPECT_EQ(watch.ticks_in(RobotState::kDisarmed, 1000), 1000);
}

}  // namespace
}  // namespace screed
