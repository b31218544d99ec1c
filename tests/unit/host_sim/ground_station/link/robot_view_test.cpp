// What the dashboard knows and draws: pages of characters, values, losses, faults in words.
#include "host_sim/ground_station/link/robot_view.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "firmware/protocol/e2e.h"
#include "firmware/protocol/messages.h"
#include "host_sim/core/errors.h"
#include "host_sim/ground_station/link/dashboard.h"
#include "host_sim/ground_station/link/text_canvas.h"

namespace screed {
namespace {

// ---- pages

TEST(TextCanvas, TextIsCutAtTheEdgesAndCountedInCharacters) {
  TextCanvas page(6, 2);
  EXPECT_EQ(page.text(0, 0, "0.5 °"), 5);
  page.text(4, 1, "abcdef");
  page.text(-1, 1, "xy");
  page.text(0, 7, "below");
  EXPECT_EQ(page.str(), "0.5 °\ny   ab\n");
}

TEST(TextCanvas, WhatIsNoUtf8IsAQuestionMark) {
  EXPECT_EQ(from_utf8("a\xFF"
                      "b\xC3"),
            U"a?b?");
  EXPECT_EQ(utf8(U'é') + utf8(U'█') + utf8(U'\U0001F916'), "é█🤖");
  EXPECT_EQ(from_utf8("é█🤖"), U"é█🤖");
}

TEST(TextCanvas, ABarGrowsFromItsMiddle) {
  TextCanvas page(9, 3);
  page.centred_bar(0, 0, 9, 0.5, CellStyle::kGood);
  page.centred_bar(0, 1, 9, -7.0, CellStyle::kGood);
  page.centred_bar(0, 2, 9, 0.0, CellStyle::kGood);
  EXPECT_EQ(page.str(), "····│██··\n████│····\n····│····\n");
}

TEST(TextCanvas, ACurveIsDrawnInDots) {
  TextCanvas page(2, 1);
  // From the lower left dot to the upper right one.
  const std::vector<CurvePoint> line = {{0.0, 0.0}, {3.0, 3.0}};
  page.curve(0, 0, 2, 1, line, {0.0, 3.0, 0.0, 3.0});
  EXPECT_EQ(page.str(), "⡠⠊\n");
  TextCanvas gap(2, 1);
  const std::vector<CurvePoint> broken = {
      {0.0, 0.0}, {1.0, std::numeric_limits<double>::quiet_NaN()}, {3.0, 9.0}};
  gap.curve(0, 0, 2, 1, broken, {0.0, 3.0, 0.0, 3.0});
  EXPECT_EQ(gap.str(), "⡀⠈\n");
}

// ---- what a robot says

constexpr uint64_t kStart_us = 1'700'000'000'000'000;

template <class Message>
LinkFrame frame_with(const Message& message, uint8_t counter, uint64_t time_us) {
  LinkFrame frame;
  frame.time_us = time_us;
  frame.frame = frame_of(message);
  e2e_protect(frame.frame.id, counter, frame.frame.data, frame.frame.size);
  return frame;
}

message::Attitude attitude(int16_t roll_cdeg, int16_t pitch_cdeg) {
  message::Attitude attitude{};
  attitude.roll = roll_cdeg;
  attitude.pitch = pitch_cdeg;
  attitude.heading = 9000;
  return attitude;
}

message::Heartbeat heartbeat(message::HeartbeatState state, uint16_t faults) {
  message::Heartbeat heartbeat{};
  heartbeat.state = static_cast<uint8_t>(state);
  heartbeat.faults = faults;
  heartbeat.boot_epoch = 7;
  return heartbeat;
}

TEST(RobotView, ValuesAreTheNewestInTheirUnits) {
  FleetView fleet;
  ASSERT_NE(fleet.add_frame(frame_with(attitude(-1234, 500), 0, kStart_us)), nullptr);
  RobotView* const robot = fleet.add_frame(frame_with(attitude(-1235, 501), 1, kStart_us + 40'000));
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

TEST(RobotView, LostFramesAreCountedByTheAliveCounter) {
  FleetView fleet;
  RobotView* robot = nullptr;
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

TEST(RobotView, DamagedAndForeignFramesAreCountedAndNotShown) {
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

TEST(RobotView, RobotsAreToldApartByModuleAndNode) {
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

TEST(RobotView, WhatHappensIsSaidInWords) {
  FleetView fleet;
  fleet.add_frame(frame_with(heartbeat(message::HeartbeatState::kDisarmed, 0), 0, kStart_us));
  const auto stall = static_cast<uint16_t>(message::HeartbeatFaults::kStallLeft);
  RobotView* const robot = fleet.add_frame(
      frame_with(heartbeat(message::HeartbeatState::kFault, stall), 1, kStart_us + 200'000));
  ASSERT_NE(robot, nullptr);
  EXPECT_EQ(robot->faults(), std::vector<std::string>{"stall left: high duty, no motion"});
  message::CommandAck ack{};
  ack.op = static_cast<uint8_t>(CommandOp::kArm);
  ack.result = static_cast<uint8_t>(message::CommandAckResult::kFaultPresent);
  fleet.add_frame(frame_with(ack, 0, kStart_us + 300'000));
  message::Heartbeat restarted = heartbeat(message::HeartbeatState::kDisarmed, 0);
  restarted.boot_epoch = 8;
  fleet.add_frame(frame_with(restarted, 0, kStart_us + 400'000));

  std::vector<std::string> words;
  for (const RobotView::Event& event : robot->events()) words.push_back(event.words);
  EXPECT_EQ(words, (std::vector<std::string>{
                       "the robot restarted, start 8", "fault gone: stall left", "state: disarmed",
                       "arm: fault present", "fault: stall left: high duty, no motion",
                       "state: fault", "state: disarmed"}));
}

// ---- the dashboard

class DashboardTest : public ::testing::Test {
 protected:
  DashboardTest() {
    const auto tilt = static_cast<uint16_t>(message::HeartbeatFaults::kTilt);
    fleet_.add_frame(frame_with(heartbeat(message::HeartbeatState::kFault, tilt), 0, kStart_us));
    for (int i = 0; i < 100; ++i) {
      fleet_.add_frame(frame_with(attitude(static_cast<int16_t>(i * 10), -700), i & 0xF,
                                  kStart_us + static_cast<uint64_t>(i) * 40'000));
    }
    input_.now_us = kStart_us + 4'000'000;
    input_.link_name = "vcan0";
    input_.link.up = true;
    input_.link.text = "up";
    input_.fleet = &fleet_;
    input_.curves = {"attitude.roll"};
    input_.footer = "keys";
  }

  std::string draw(int width, int height) {
    TextCanvas page(width, height);
    draw_dashboard(page, input_);
    return page.str();
  }

  FleetView fleet_;
  DashboardInput input_;
};

TEST_F(DashboardTest, ShowsLinkStateValuesAndFaultsInWords) {
  const std::string page = draw(120, 40);
  for (const char* words : {"vcan0 up", "robot 1 fault", "9.90 deg", "-7.00 deg",
                            "tilt: inclination beyond the limit", "attitude.roll deg", "keys"}) {
    EXPECT_NE(page.find(words), std::string::npos) << words << "\n" << page;
  }
}

TEST_F(DashboardTest, FitsEveryTerminal) {
  for (const int width : {1, 20, 80, 300}) {
    for (const int height : {1, 2, 24, 100}) {
      const std::string page = draw(width, height);
      EXPECT_EQ(std::count(page.begin(), page.end(), '\n'), height);
    }
  }
}

TEST_F(DashboardTest, ASilentRobotIsCalledSilent) {
  EXPECT_EQ(draw(120, 40).find("SILENT"), std::string::npos);
  input_.now_us += 5'000'000;
  EXPECT_NE(draw(120, 40).find("SILENT for 5"), std::string::npos);
  const FleetView nobody;
  input_.fleet = &nobody;
  EXPECT_NE(draw(120, 40).find("no robot heard yet"), std::string::npos);
}

TEST_F(DashboardTest, APlainReportHasEveryValueOnce) {
  const std::string report = plain_report(input_);
  for (const char* words :
       {"link vcan0: up", "robot 1: fault, 101 frames, 0 lost", "  fault: tilt: inclination",
        "  attitude: roll 9.90 deg pitch -7.00 "}) {
    EXPECT_NE(report.find(words), std::string::npos) << words << "\n" << report;
  }
}

}  // namespace
}  // namespace screed
