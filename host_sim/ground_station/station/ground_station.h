// The ground station of a simulated run: heartbeat, arm, run, drive commands up; everything that
// comes down is logged.
//
// The log is `candump -L` text, so that can-utils, Wireshark and python-can read it as it is.
#pragma once

#include <cstdint>
#include <optional>
#include <ostream>
#include <span>
#include <vector>

#include "firmware/protocol/messages.h"
#include "firmware/protocol/slcan.h"
#include "firmware/robot/supervisor.h"
#include "host_sim/ground_station/station/command_signer.h"
#include "host_sim/ground_station/station/position_fixes.h"

namespace screed {

/// What the ground station sends once the robot runs, for the algorithm "drive".
struct DriveCommand {
  double speed_m_per_s = 0.0;
  double yaw_rate_deg_per_s = 0.0;
};

/// What the ground station has heard.
struct RobotReport {
  bool heard = false;
  RobotState state = RobotState::kDisarmed;
  uint16_t faults = 0;
  /// The last answer to a command.
  std::optional<message::CommandAck> answer;
};

class GroundStation {
 public:
  /// log may be null. fixes: sent from the first heartbeat on. arm: arm and start the robot as soon
  /// as it is ready.
  GroundStation(bool arm, std::optional<DriveCommand> drive, std::ostream* log,
                const CommandKey& key = test_key(),
                const std::optional<PositionFixes>& fixes = std::nullopt)
      : arm_(arm), drive_(drive), log_(log), signer_(key), fixes_(fixes) {}

  /// What an overhead camera sees: where the robot is, m.
  void see_robot(double x_m, double y_m) {
    robot_x_m_ = x_m;
    robot_y_m_ = y_m;
  }

  /// Takes what came down since the last tick.
  void receive(uint64_t now_us, std::span<const uint8_t> bytes);
  /// What goes up in this tick: whole lines, one packet.
  std::vector<uint8_t> transmit(uint64_t now_us);

  const RobotReport& report() const { return report_; }
  uint64_t frames() const { return frames_; }
  uint64_t rejected_frames() const { return rejected_; }

 private:
  void handle_message(uint64_t now_us, const CanFrame& frame);
  void add_frame(CanFrame frame, uint8_t& counter, std::vector<uint8_t>& lines);
  static void add_line(const CanFrame& frame, std::vector<uint8_t>& lines);

  bool arm_;
  std::optional<DriveCommand> drive_;
  std::ostream* log_;
  CommandSigner signer_;
  std::optional<PositionFixes> fixes_;
  double robot_x_m_ = 0.0;
  double robot_y_m_ = 0.0;
  SlcanParser parser_;
  RobotReport report_;
  uint64_t frames_ = 0;
  uint64_t rejected_ = 0;
  uint64_t ticks_ = 0;
  bool started_ = false;  ///< the robot has been running: it is not started twice
  uint8_t heartbeat_counter_ = 0;
};

}  // namespace screed
