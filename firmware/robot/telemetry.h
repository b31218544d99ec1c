// The downlink: which frame is due when, and its bytes.
//
// The radio module sends what it was given when the line falls silent, at most 100 bytes at once,
// and what is lost is lost as a whole. So lines are handed over in packets of whole lines, at most
// four (88 bytes), every second tick: they take 15.3 of 20 ms. What happened once goes first, then
// what is due by its rate, in order of importance, as far as the byte budget goes: half of what the
// line carries.
#pragma once

#include <stdint.h>

#include "firmware/leveling/leveling.h"
#include "firmware/protocol/messages.h"
#include "firmware/robot/robot_status.h"
#include "hal/sample.h"

namespace screed {

/// Everything the downlink may say, gathered by the robot once a tick. What it points to is read in
/// that tick alone.
struct TelemetryView {
  const SensorSample* sample;
  const RobotStatus* robot;
  uint8_t sigma_heading;  ///< AttitudeEstimator::heading_sigma()
  bool mag_disturbed;
  uint8_t travel_share;  ///< SlipWatch::travel_share()
  const UplinkCounts* uplink;
  uint8_t slip;     ///< 1: the tracks move much more than the robot
  uint8_t stuck;    ///< 1: and have done so for long
  uint16_t faults;  ///< latched ones in kFault, else those present
  bool starting;    ///< the attitude estimator is not ready
  bool link_alive;
  uint16_t boot_epoch;
  uint16_t freshness;  ///< counter of the last command that was accepted
  uint8_t rejected_lines;
  uint8_t rejected_commands;
  LevelingAlgorithm algorithm;
  LevelingState leveling_state;
  uint16_t peaks;
};

constexpr uint8_t kTelemetryMessages = kPeriodicMessages;  ///< sent by their rate
constexpr uint8_t kMessageClasses = 6;                     ///< of ids of such messages, id >> 8

/// What the downlink remembers, zero at the start: zeroed at once, which takes less flash.
struct TelemetryMemory {
  static constexpr uint8_t kQueue = 4;

  CanFrame queue_[kQueue];
  uint8_t first_queued_;
  uint8_t queued_;
  uint8_t next_packet_;  ///< ticks
  uint8_t credit_;       ///< bytes
  uint16_t due_;         ///< a bit a message: it waits for room
  static_assert(kTelemetryMessages <= 16, "due_ has a bit for each");
  uint8_t countdown_[kTelemetryMessages];
  uint8_t counter_[kTelemetryMessages + kMessageClasses];
  bool started_;
  uint8_t heartbeats_before_;  ///< UplinkCounts::ground_heartbeats at the last LINK
  uint16_t longest_tick_us_;   ///< since the last HEALTH
  uint32_t time_ms_;           ///< at the last TIME; the sample's time wraps after 71.6 minutes
  uint32_t time_us_;           ///< the sample's, then
};

/// The node as a base: on the AVR it is empty, and then takes no byte.
class Telemetry : private TelemetryMemory, private OwnNode {
 public:
  /// robot_id: as Credentials has it.
  explicit Telemetry(uint8_t robot_id) : TelemetryMemory(), OwnNode(robot_id) {}

  using OwnNode::exchange;

  static constexpr uint8_t kPacketTicks = 2;
  /// Half of 57,600 baud for the time of a packet.
  static constexpr uint8_t kPacketBudget = 57;

  /// Queues a frame (COMMAND_ACK, PARAM_VALUE or EVENT) to go before all others, its protection
  /// still missing. Dropped when four are waiting.
  void queue(const CanFrame& frame);

  /// tick() will hand over a packet: there is more to compute than in other ticks.
  bool is_packet_tick() const { return next_packet_ == 0; }

  /// One tick: writes the lines of a packet into output.radio_out, when it is time for one, whole
  /// lines only. What does not fit waits for the next one.
  void tick(const TelemetryView& view, RobotOutput& output);

 private:
  void emit(CanFrame& frame, uint8_t message, RobotOutput& output);
  bool room(const RobotOutput& output) const;
  /// Call once per sent frame: HEALTH and LINK start new intervals here.
  void fill(CanFrame& frame, const TelemetryView& view);
};

}  // namespace screed
