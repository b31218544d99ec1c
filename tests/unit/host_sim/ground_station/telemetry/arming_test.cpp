// Why a robot cannot be armed, in words: from telemetry that says so, and from a real robot.
#include "host_sim/ground_station/telemetry/arming.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/unit/host_sim/ground_station/said_frames.h"
#include "tests/unit/test_robot.h"

namespace screed {
namespace {

using Sentences = std::vector<std::string>;
using State = message::HeartbeatState;
using Result = message::CommandAckResult;

class ArmingTest : public ::testing::Test {
 protected:
  template <class Message>
  void say(const Message& message) {
    const CanFrame frame = frame_of(message);
    robot_.add_frame(kStart_us, frame, *find_message(frame.id));
  }
  void say_state(State state, uint16_t faults, bool link = true) {
    message::Heartbeat it = heartbeat(state, faults);
    it.link_alive = link ? 1 : 0;
    say(it);
  }
  Sentences obstacles(double seconds_later = 0.0) const {
    return arming_obstacles(robot_, kStart_us + static_cast<uint64_t>(seconds_later * 1e6));
  }

  LatestTelemetry robot_;
};

TEST_F(ArmingTest, ARobotThatIsReadyHasNoObstacleNorOneThatIsNotHeard) {
  EXPECT_EQ(obstacles(), Sentences{});
  say_state(State::kDisarmed, 0);
  EXPECT_EQ(obstacles(), Sentences{});
  say(message::Health{});
  EXPECT_EQ(obstacles(), Sentences{});
}

TEST_F(ArmingTest, ABatteryIsBelowTheLimitThatTheRobotHas) {
  say_state(State::kDisarmed, Fault::kBattery);
  EXPECT_EQ(obstacles(), Sentences{"battery below battery_low 6.00 V (the default)"});
  say(message::Power{5800, 0});
  EXPECT_EQ(obstacles(), Sentences{"battery 5.80 V below battery_low 6.00 V (the default)"});
  // More than the default: this robot's limit is another one, and is not guessed.
  say(message::Power{7100, 0});
  EXPECT_EQ(obstacles(), Sentences{"battery below battery_low, 7.10 V now"});
  EXPECT_EQ(limits_to_read(Fault::kBattery, robot_), std::vector<std::string_view>{"battery_low"});
  robot_.set_parameter("battery_low", 9000);
  EXPECT_EQ(obstacles(), Sentences{"battery 7.10 V below battery_low 9.00 V"});
  EXPECT_TRUE(limits_to_read(Fault::kBattery, robot_).empty());
  EXPECT_TRUE(limits_to_read(Fault::kStuck, robot_).empty());
}

TEST_F(ArmingTest, ATiltHasItsAngleAndItsLimit) {
  say_state(State::kDisarmed, Fault::kTilt);
  EXPECT_EQ(obstacles(), Sentences{"tilted beyond tilt_limit 50 degrees (the default)"});
  say(attitude(8000, 6000));  // cos 80 cos 60: 85 degrees
  robot_.set_parameter("tilt_limit", 4000);
  EXPECT_EQ(obstacles(), Sentences{"tilted 85 degrees, tilt_limit 40 degrees"});
  say(message::AccelRaw{0, 0, 4098});  // pushed: it seems level
  EXPECT_EQ(obstacles(), Sentences{"tilted 85 degrees, tilt_limit 40 degrees"});
  // An estimator that has not followed: the accelerometer sees the robot upside down.
  say(attitude(0, 0));
  EXPECT_EQ(obstacles(), Sentences{"tilted beyond tilt_limit, 0 degrees now"});
  say(message::AccelRaw{0, 0, -4098});
  EXPECT_EQ(obstacles(), Sentences{"tilted 180 degrees, tilt_limit 40 degrees"});
}

TEST_F(ArmingTest, OtherFaultsAreSaidInTheSchemasWords) {
  say_state(State::kDisarmed, Fault::kGyroFrozen | Fault::kGyroChip);
  EXPECT_EQ(obstacles(), (Sentences{"gyro frozen: the gyro repeats itself to the bit",
                                    "gyro chip: L3GD20H does not answer or lost its settings"}));
}

TEST_F(ArmingTest, StartUpHasTheTimeThatIsLeft) {
  say_state(State::kDisarmed, 0);
  message::Health health{};
  health.conditions = message::HealthConditions::kStarting;
  say(health);
  EXPECT_EQ(obstacles(), Sentences{"start-up needs 4.5 s at rest"});
  say(message::Time{2000, 0});
  EXPECT_EQ(obstacles(), Sentences{"start-up needs 4.5 s at rest, 2.5 s left"});
  EXPECT_EQ(obstacles(0.4), Sentences{"start-up needs 4.5 s at rest, 2.1 s left"});
  EXPECT_EQ(obstacles(9.0), Sentences{"start-up needs 4.5 s at rest; keep the robot still"});
}

TEST_F(ArmingTest, WithoutAGroundStationOnlyAStandaloneRobotIsArmed) {
  say_state(State::kDisarmed, 0, false);
  EXPECT_EQ(obstacles(), Sentences{"the robot hears no ground station"});
  robot_.set_parameter("standalone", 1);
  EXPECT_EQ(obstacles(), Sentences{});
}

TEST_F(ArmingTest, AGateThatRefusesIsAnObstacleUntilItAccepts) {
  say_state(State::kDisarmed, 0);
  message::CommandAck ack{};
  ack.result = static_cast<uint8_t>(Result::kBadMac);
  say(ack);
  EXPECT_EQ(obstacles(),
            Sentences{"commands are refused: signed with another key than the robot's (--key)"});
  ack.result = static_cast<uint8_t>(Result::kLockedOut);
  ack.detail = 301;
  say(ack);
  EXPECT_EQ(obstacles(),
            Sentences{"commands are refused: too many wrong signatures; locked for 4 s"});
  ack.result = static_cast<uint8_t>(Result::kNotReady);
  say(ack);
  EXPECT_EQ(obstacles(), Sentences{});
}

TEST_F(ArmingTest, ALatchedFaultIsAnObstacleThatOutlivesItsCause) {
  say(message::Power{7100, 0});
  robot_.set_parameter("battery_low", 6000);
  say_state(State::kFault, Fault::kBattery, false);
  EXPECT_EQ(obstacles(), (Sentences{"battery below battery_low, 7.10 V now",
                                    "the fault is latched until it is cleared"}));
  for (const State state : {State::kArmed, State::kRunning, State::kStopped}) {
    say_state(state, 0, false);
    EXPECT_EQ(obstacles(), Sentences{}) << "armed already";
  }
}

// ---- a real robot: its answer to "arm", and the sentences made of what it says

struct Case {
  const char* name;
  void (*prepare)(TestRobot&);
  Result result;
  Sentences sentences;
};

TEST(Arming, SentencesAreThereExactlyWhenTheRobotRefuses) {
  const Case cases[] = {
      {"ready", [](TestRobot&) {}, Result::kDone, {}},
      {"low",
       [](TestRobot& robot) { robot.sample.battery = 2730; },
       Result::kFaultPresent,
       {"battery 5.00 V below battery_low 6.00 V (the default)"}},
      {"on its side",
       [](TestRobot& robot) {
         robot.sample.imu.accel()[1] = 4098;
         robot.sample.imu.accel()[2] = 0;
       },
       Result::kFaultPresent,
       {"tilted 90 degrees, tilt_limit 50 degrees (the default)"}},
      {"unheard",
       [](TestRobot& robot) { robot.heartbeats = false; },
       Result::kNoLink,
       {"the robot hears no ground station"}},
  };
  for (const Case& it : cases) {
    TestRobot robot;
    LatestTelemetry said;
    SlcanParser parser;
    const auto run = [&](int ticks) {
      for (int i = 0; i < ticks; ++i) {
        robot.tick();
        CanFrame frame{};
        for (uint8_t at = 0; at < robot.output.radio_out_count; ++at) {
          if (!parser.feed(robot.output.radio_out[at], frame)) continue;
          said.add_frame(robot.sample.time_us, frame, *find_message(frame.id));
        }
      }
    };
    run(200);
    EXPECT_FALSE(arming_obstacles(said, robot.sample.time_us).empty()) << "starting up";
    run(400);
    it.prepare(robot);
    run(500);
    EXPECT_EQ(arming_obstacles(said, robot.sample.time_us), it.sentences) << it.name;
    robot.send(robot.command(CommandOp::kArm));
    const auto answer = robot.answer();
    ASSERT_TRUE(answer.has_value()) << it.name;
    EXPECT_EQ(answer->result, static_cast<uint8_t>(it.result)) << it.name;
  }
}

}  // namespace
}  // namespace screed
