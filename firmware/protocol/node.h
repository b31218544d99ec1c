// Which robot a frame is of: bits 4 to 7 of its id. Node 0 is the ground, robots are 1 to 15.
//
// The schema, and all code that makes and reads messages, has the ids of node 1. They become those
// of the robot where frames leave it and enter it.
#pragma once

#include <stdint.h>

namespace screed {

constexpr uint8_t kMaxNode = 15;

/// The node of an id: 0 the ground, 1..15 a robot.
constexpr uint8_t node_of(uint16_t id) {
  return (id >> 4) & 0xFU;
}

/// The id of a robot's message: that of any robot, moved to another node; ids of node 0 stay.
constexpr uint16_t id_of_node(uint16_t id, uint8_t node) {
  return node_of(id) == 0 ? id : static_cast<uint16_t>((id & 0x70FU) | (node & 0xFU) << 4);
}

/// The id of a message of this node as that of node 1, and the other way round; ids of other nodes
/// stay. So code that knows the ids of node 1 alone takes nothing for its own that is another
/// robot's.
constexpr uint16_t exchange_node_1(uint16_t id, uint8_t node) {
  return node_of(id) == node || node_of(id) == 1 ? static_cast<uint16_t>(id ^ (node ^ 1U) << 4)
                                                 : id;
}

/// The node of a robot by the id that stands behind its key: the same number from 1 to 15, then
/// from 1 again; 0 is node 1.
constexpr uint8_t node_of_robot(uint8_t robot_id) {
  return static_cast<uint8_t>(robot_id == 0 ? 1 : (robot_id - 1) % kMaxNode + 1);
}

/// The node of this robot.
#ifdef __AVR__
/// A constant of the image (make firmware NODE=3), which for node 1 takes no flash.
#ifndef SCREED_NODE
#define SCREED_NODE 1
#endif
class OwnNode {
 public:
  explicit OwnNode(uint8_t /*robot_id*/) {}

  /// exchange_node_1() with this robot's node.
  static constexpr uint16_t exchange(uint16_t id) {
    return SCREED_NODE == 1 ? id : exchange_node_1(id, SCREED_NODE);
  }
};
static_assert(SCREED_NODE >= 1 && SCREED_NODE <= kMaxNode, "NODE is 1 to 15");
#else
/// Here each of many robots has its own.
class OwnNode {
 public:
  explicit OwnNode(uint8_t robot_id) : node_(node_of_robot(robot_id)) {}

  uint16_t exchange(uint16_t id) const { return exchange_node_1(id, node_); }

 private:
  uint8_t node_;
};
#endif

}  // namespace screed
