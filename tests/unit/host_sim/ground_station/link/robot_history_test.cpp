// What a robot has said: values, losses, what happened in words.
#include "host_sim/ground_station/link/robot_history.h"

#include <gtest/gtest.h>

#include "host_sim/core/errors.h"
#include "tests/unit/host_sim/ground_station/said_frames.h"

namespace screed {
namespace {

TEST(RobotHistory, ValuesAreTheNewestInTheirUnits) {
  FleetView fleet;
  ASSERT_NE(fleet.add_frame(frame_with(attitude(-1234, 500), 0, kStart_us)), nullptr);
  RobotHistory* const robot =
      fleet.add_frame(frame_with(attitude(-1235, 501), 1, kStart_us + 40'000));
  ASSERT_NE(robot, nullptr);
  EXPECT_DOUBLE_EQ(robot->value("attitude.roll").value_or(0.0), -12.35);
  EXPECT_EQ(robot->text("attitude.pitch"), "5.01");
  EXPECT_EQ(robot->text("odometry.x"), "-");
  EXPECT_FALSE(robot->value("odometry.x").has_value());
  EXPECT_THROW(robot->text("attitude.nonsense"), InputError);

  const std::vector<CurvePoint> curve =
      robot->curve(find_signal("attitude.roll"), kStart_us + 100'000, 0.08);
  ASSERT_EQ(curve.size(), 1U);
  EXPECT_NEAR(curve[0].x, -0.06, 1e-12);
  EXPECT_DOUBLE_EQ(curve[0].y, -12.35);
}

TEST(RobotHistory, LostFramesAreCountedByTheAliveCounter) {
  FleetView fleet;
  RobotHistory* robot = nullptr;
  uint64_t time_us = kStart_us;
  // 100 frames are sent, of which each tenth is lost.
  for (int i = 0; i < 100; ++i, time_us += 40'000) {
    if (i % 10 != 5) robot = fleet.add_frame(frame_with(attitude(0, 0), i & 0xF, time_us));
  }
  ASSERT_NE(robot, nullptr);
  EXPECT_EQ(robot->frames(), 90U);
  EXPECT_EQ(robot->lost(), 10U);
  EXPECT_NEAR(robot->loss_percent(time_us).value_or(0.0), 10.0, 0.1);
  EXPECT_NEAR(robot->rate_hz(*find_message("ATTITUDE"), time_us), 22.5, 1.0);
  EXPECT_NEAR(robot->frames_per_s(time_us), 22.5, 1.0);
}

// The counter runs modulo 16, and each message has its own.
TEST(RobotHistory, TheSameCounterAgainIsNoLossAndAGapIsOneOverItsEndToo) {
  FleetView fleet;
  uint64_t time_us = kStart_us;
  const auto lost_after = [&](uint8_t counter) {
    return fleet.add_frame(frame_with(attitude(0, 0), counter, time_us += 40'000))->lost();
  };
  EXPECT_EQ(lost_after(14), 0U) << "nothing is known of what came before the first";
  EXPECT_EQ(lost_after(14), 0U) << "a doubled frame, or a robot that restarted";
  EXPECT_EQ(lost_after(15), 0U);
  EXPECT_EQ(lost_after(0), 0U);
  EXPECT_EQ(lost_after(2), 1U) << "1";
  EXPECT_EQ(lost_after(1), 15U) << "3 to 15, and 0";
  RobotHistory* const robot =
      fleet.add_frame(frame_with(heartbeat(message::HeartbeatState::kDisarmed, 0), 9, time_us));
  EXPECT_EQ(robot->lost(), 15U);
  EXPECT_EQ(robot->frames(), 7U);
  // 15 of 22 that were sent.
  EXPECT_NEAR(robot->loss_percent(time_us).value_or(0.0), 100.0 * 15.0 / 22.0, 1e-9);
}

TEST(RobotHistory, LossesAreForgottenAfterTheWindowAndSamplesAfterTheHistory) {
  FleetView fleet;
  const SignalRef roll = find_signal("attitude.roll");
  fleet.add_frame(frame_with(attitude(0, 0), 0, kStart_us));
  // Five of seven are lost before the last of these, and none later.
  RobotHistory* const robot = fleet.add_frame(frame_with(attitude(0, 0), 6, kStart_us + 1'000'000));
  EXPECT_NEAR(robot->loss_percent(kStart_us + 1'000'000).value_or(0.0), 100.0 * 5.0 / 7.0, 1e-9);
  const uint64_t late_us = kStart_us + 1'000'001 + RobotHistory::kWindow_us;
  fleet.add_frame(frame_with(attitude(0, 0), 7, late_us));
  EXPECT_EQ(robot->loss_percent(late_us), 0.0);
  EXPECT_EQ(robot->lost(), 5U) << "of all time";
  EXPECT_EQ(robot->curve(roll, late_us, 1e6).size(), 3U);
  const uint64_t end_us = kStart_us + 1'000'000 + RobotHistory::kHistory_us;
  fleet.add_frame(frame_with(attitude(0, 0), 8, end_us));
  EXPECT_EQ(robot->curve(roll, end_us, 1e6).size(), 3U) << "without the first one";
}

TEST(RobotHistory, DamagedAndForeignFramesAreCountedAndNotShown) {
  FleetView fleet;
  LinkFrame damaged = frame_with(attitude(0, 0), 0, kStart_us);
  damaged.frame.data[3] ^= 1U;
  EXPECT_EQ(fleet.add_frame(damaged), nullptr);
  LinkFrame unknown;
  unknown.frame = {0x7FF, 3, {1, 2, 3}};
  EXPECT_EQ(fleet.add_frame(unknown), nullptr);
  EXPECT_EQ(fleet.add_frame(frame_with(message::GroundHeartbeat{1}, 0, kStart_us)), nullptr);
  EXPECT_EQ(fleet.damaged(), 1U);
  EXPECT_EQ(fleet.unknown(), 1U);
  EXPECT_EQ(fleet.uplink(), 1U);
  EXPECT_TRUE(fleet.robots().empty());
}

TEST(RobotHistory, RobotsAreToldApartByModuleAndNode) {
  FleetView fleet;
  LinkFrame frame = frame_with(attitude(100, 0), 0, kStart_us);
  frame.source = RadioSource{0x0013A20040522BAA, -60};
  fleet.add_frame(frame);
  frame.source = RadioSource{0x0013A20040522BAB, -70};
  fleet.add_frame(frame);
  ASSERT_EQ(fleet.robots().size(), 2U);
  EXPECT_EQ(fleet.robots().begin()->first.text(), "robot 1 at 0013A20040522BAA");
  EXPECT_EQ(fleet.robots().begin()->second.rssi_dbm(), -60);
}

TEST(RobotHistory, WhatHappensIsSaidInWords) {
  FleetView fleet;
  fleet.add_frame(frame_with(heartbeat(message::HeartbeatState::kDisarmed, 0), 0, kStart_us));
  const auto stall = static_cast<uint16_t>(message::HeartbeatFaults::kStallLeft);
  RobotHistory* const robot = fleet.add_frame(
      frame_with(heartbeat(message::HeartbeatState::kFault, stall), 1, kStart_us + 200'000));
  ASSERT_NE(robot, nullptr);
  EXPECT_EQ(robot->faults(), std::vector<std::string>{"stall left: high duty, no motion"});
  message::CommandAck ack{};
  ack.op = static_cast<uint8_t>(CommandOp::kArm);
  ack.result = static_cast<uint8_t>(message::CommandAckResult::kFaultPresent);
  ack.detail = stall;
  fleet.add_frame(frame_with(ack, 0, kStart_us + 300'000));
  message::Heartbeat restarted = heartbeat(message::HeartbeatState::kDisarmed, 0);
  restarted.boot_epoch = 8;
  fleet.add_frame(frame_with(restarted, 0, kStart_us + 400'000));

  std::vector<std::string> words;
  for (const RobotHistory::Event& event : robot->events()) words.push_back(event.words);
  EXPECT_EQ(words,
            (std::vector<std::string>{
                "the robot restarted, start 8", "gone: stall left", "state: disarmed",
                "arm: refused: stall left: high duty, no motion",
                "fault: stall left: high duty, no motion", "state: fault", "state: disarmed"}));
}

TEST(RobotHistory, WhatPreventsArmingIsNoFaultYet) {
  FleetView fleet;
  const auto battery = static_cast<uint16_t>(message::HeartbeatFaults::kBattery);
  message::Heartbeat low = heartbeat(message::HeartbeatState::kDisarmed, battery);
  low.link_alive = 1;
  RobotHistory* const robot = fleet.add_frame(frame_with(low, 0, kStart_us));
  ASSERT_NE(robot, nullptr);
  EXPECT_EQ(robot->events().front().words,
            "prevents arming: battery below battery_low 6.00 V (the default)");
  EXPECT_EQ(robot->obstacles(kStart_us).size(), 1U);
}

TEST(RobotHistory, AParameterThatIsReadIsNoEvent) {
  FleetView fleet;
  message::CommandAck ack{};
  ack.op = static_cast<uint8_t>(CommandOp::kParameterRead);
  RobotHistory* const robot = fleet.add_frame(frame_with(ack, 0, kStart_us));
  ASSERT_NE(robot, nullptr);
  EXPECT_TRUE(robot->events().empty());
  ack.result = static_cast<uint8_t>(message::CommandAckResult::kBadArgument);
  fleet.add_frame(frame_with(ack, 1, kStart_us));
  EXPECT_EQ(robot->events().size(), 1U);
}

}  // namespace
}  // namespace screed
