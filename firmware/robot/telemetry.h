// The downlink: which frame is due when. What a frame says is the robot's (report.cpp).
//
// The radio module sends what it was given when the line falls silent, at most 100 bytes at once,
// and what is lost is lost as a whole. So lines are handed over in packets of whole lines, at most
// four (88 bytes), every second tick: they take 15.3 of 20 ms. What happened once goes first, then
// what is due by its rate, in order of importance, as far as the byte budget goes: half of what the
// line carries.
#pragma once

#include <stdint.h>

#include "firmware/protocol/messages.h"
#include "hal/sample.h"

namespace screed {

constexpr uint8_t kTelemetryMessages = kPeriodicMessages;  ///< sent by their rate
constexpr uint8_t kMessageClasses = 6;                     ///< of ids of such messages, id >> 8

/// The node as a base: on the AVR it is empty, and then takes no byte.
class Telemetry : private OwnNode {
 public:
  /// robot_id: as Credentials has it.
  explicit Telemetry(uint8_t robot_id);

  using OwnNode::exchange;

  static constexpr uint8_t kPacketTicks = 2;
  /// Half of 57,600 baud for the time of a packet.
  static constexpr uint8_t kPacketBudget = 57;

  /// Queues a frame (COMMAND_ACK, PARAM_VALUE or EVENT) to go before all others, its protection
  /// still missing. Dropped when four are waiting.
  void queue(const CanFrame& frame);

  /// This tick will hand over a packet: there is more to compute than in other ticks.
  bool is_packet_tick() const { return state_.next_packet == 0; }

  /// Begins a tick: empties output.radio_out and, when it is time for a packet, writes the queued
  /// frames into it. Then each message in turn, from 0 to kTelemetryMessages - 1: where due() says
  /// so its frame is filled and sent. Whole lines only; what does not fit waits for the next
  /// packet.
  void begin_tick(RobotOutput& output);
  bool due(uint8_t message, const RobotOutput& output);
  /// The id of a message, as of node 1.
  static uint16_t id(uint8_t message);
  /// Writes the frame's line; id, size and data stand, the protection is still missing.
  void send(CanFrame& frame, uint8_t message, RobotOutput& output);

 private:
  static constexpr uint8_t kQueue = 4;
  struct State {
    CanFrame queue[kQueue];
    uint8_t first_queued;
    uint8_t queued;
    uint8_t next_packet;  ///< ticks
    uint8_t credit;       ///< bytes
    uint8_t countdown[kTelemetryMessages];
    bool waits[kTelemetryMessages];  ///< for room
    uint8_t counter[kTelemetryMessages + kMessageClasses];
  };

  bool room(const RobotOutput& output) const;

  State state_{};  // zeroed at once, which takes less flash
};

}  // namespace screed
