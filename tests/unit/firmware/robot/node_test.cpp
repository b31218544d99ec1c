// A robot among others on the same radio: its messages carry its node, and it takes nothing for its
// own that is another robot's.
#include "firmware/protocol/node.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/unit/test_robot.h"

namespace screed {
namespace {

CommandKey key_of(uint8_t robot_id) {
  CommandKey key = test_key();
  key.robot_id = robot_id;
  return key;
}

/// Ids of the frames that a robot sends in a second.
std::set<uint16_t> ids_sent(TestRobot& robot) {
  std::set<uint16_t> ids;
  SlcanParser parser;
  CanFrame frame{};
  for (int i = 0; i < kTickRate_hz; ++i) {
    robot.tick();
    for (uint8_t at = 0; at < robot.output.radio_out_count; ++at) {
      if (!parser.feed(robot.output.radio_out[at], frame)) continue;
      EXPECT_TRUE(e2e_check(frame.id, frame.data, frame.size)) << frame.id;
      ids.insert(frame.id);
    }
  }
  return ids;
}

CanFrame moved(CanFrame frame, uint8_t node) {
  frame.id = id_of_node(frame.id, node);
  return frame;
}

TEST(Node, OfARobotIsItsNumberAsFarAsThereAreNodes) {
  EXPECT_EQ(node_of_robot(1), 1);
  EXPECT_EQ(node_of_robot(15), 15);
  EXPECT_EQ(node_of_robot(16), 1);
  EXPECT_EQ(node_of_robot(0), 1);
  for (int id = 0; id < 256; ++id) {
    const uint8_t node = node_of_robot(static_cast<uint8_t>(id));
    EXPECT_TRUE(node >= 1 && node <= kMaxNode) << id;
  }
}

TEST(Node, TheExchangeIsItsOwnInverseAndLeavesOthersAlone) {
  for (uint8_t node = 1; node <= kMaxNode; ++node) {
    EXPECT_EQ(exchange_node_1(kIdAttitude, node), id_of_node(kIdAttitude, node));
    for (uint16_t id = 0; id < 0x800; ++id) {
      const uint16_t there = exchange_node_1(id, node);
      ASSERT_EQ(exchange_node_1(there, node), id);
      if (node_of(id) != 1 && node_of(id) != node) {
        ASSERT_EQ(there, id);
      }
    }
  }
}

TEST(Node, ARobotSendsTheMessagesOfItsNodeAlone) {
  TestRobot first(Parameters{}, key_of(1));
  const std::set<uint16_t> of_first = ids_sent(first);
  EXPECT_GE(of_first.size(), size_t{kTelemetryMessages});
  for (const uint8_t id : {uint8_t{3}, uint8_t{15}}) {
    TestRobot robot(Parameters{}, key_of(id));
    std::set<uint16_t> expected;
    for (const uint16_t one : of_first) expected.insert(id_of_node(one, id));
    EXPECT_EQ(ids_sent(robot), expected);
  }
}

TEST(Node, CommandsOfAnotherRobotAreNoneForThisOne) {
  TestRobot robot(Parameters{}, key_of(3));
  robot.run(600);
  // With this robot's own MAC, so that nothing but the id can keep it out.
  for (uint8_t node = 1; node <= kMaxNode; ++node) {
    if (node == 3) continue;
    robot.send(moved(robot.command(CommandOp::kArm), node));
    robot.run(4);
    ASSERT_EQ(robot.state(), RobotState::kDisarmed) << int{node};
    ASSERT_EQ(robot.robot.gate().refused(), 0) << "it did not look at it";
  }
  robot.send(robot.command(CommandOp::kArm));
  const auto answer = robot.answer();
  ASSERT_TRUE(answer.has_value());
  EXPECT_EQ(answer->result, static_cast<uint8_t>(message::CommandAckResult::kDone));
  EXPECT_EQ(robot.state(), RobotState::kArmed);
}

TEST(Node, ACommandUnderTheIdOfAnotherRobotHasAWrongMac) {
  // The id is under the MAC: what was signed for robot 3 is worth nothing to a robot 1 that shares
  // its key and number.
  CommandSigner signer(key_of(3));
  signer.handle_frame(moved(frame_of(message::Heartbeat{0, 0, 0, kFirstBootEpoch, 0}), 3));
  CommandGate gate(credentials_of(key_of(3)));
  const CanFrame command = signer.sign(CommandOp::kArm);
  EXPECT_EQ(gate.check(id_of_node(command.id, 1), command.data), GateResult::kBadMac);
  EXPECT_EQ(gate.check(command.id, command.data), GateResult::kAccepted);
}

TEST(Node, AnotherRobotsHeartbeatIsNoGroundStation) {
  // Robot 2's frames, as they arrive over one radio channel, in all their classes.
  TestRobot robot(Parameters{}, key_of(3));
  robot.heartbeats = false;
  robot.run(600);
  uint8_t counter = 0;
  for (int i = 0; i < 40; ++i) {
    for (const CanFrame& frame :
         {moved(frame_of(message::Heartbeat{}), 2), moved(frame_of(message::Heartbeat{}), 1),
          moved(frame_of(message::Attitude{}), 2)}) {
      robot.send(TestRobot::protect(frame, counter));
      robot.run(2);
    }
  }
  EXPECT_FALSE(robot.robot.supervisor().link_alive());
  robot.heartbeats = true;
  robot.run(60);
  EXPECT_TRUE(robot.robot.supervisor().link_alive()) << "the ground's is for all";
}

}  // namespace
}  // namespace screed
