// The ground end of a simulated radio: the simulated ground station with its position fixes, and
// the port for programs outside.
#pragma once

#include <cstdint>
#include <optional>
#include <ostream>
#include <span>
#include <vector>

#include "firmware/protocol/messages.h"
#include "firmware/protocol/slcan.h"
#include "firmware/robot/supervisor.h"
#include "host_sim/core/random.h"
#include "host_sim/devices/radio/radio_link.h"
#include "host_sim/ground_station/station/command_key.h"

namespace screed {

// The ground end of the radio for programs outside of the simulation: bytes as the radio module
// gives them out and takes them in.

class GroundPort {
 public:
  GroundPort() = default;
  GroundPort(const GroundPort&) = delete;
  GroundPort& operator=(const GroundPort&) = delete;
  virtual ~GroundPort() = default;

  /// What has come down in this tick. Never waits.
  virtual void send(std::span<const uint8_t> bytes) = 0;
  /// What is to go up. Never waits.
  virtual std::vector<uint8_t> receive() = 0;
};

// Position fixes as an overhead camera makes them: late by nothing, with noise, and missing during
// outages.

struct PositionFixOptions {
  double period_s = 0.0;        ///< 0: no fixes; else rounded to 0.25 s, at least that
  double sigma_m = 0.02;        ///< standard deviation along each axis
  double outage_every_s = 0.0;  ///< mean time from an outage to the next one; 0: none
  double outage_s = 10.0;       ///< length of each
};

class PositionFixes {
 public:
  PositionFixes(std::uint64_t seed, const PositionFixOptions& options);

  /// The argument of CommandOp::kPositionFix (cm) for a robot at (x, y), when one is due in this
  /// tick (of 10 ms, counted from 0) and no outage hides it. To be asked every tick.
  std::optional<DriveArgument> at(std::uint64_t tick, double x_m, double y_m);

 private:
  double next_outage_s();

  PositionFixOptions options_;
  std::uint64_t period_ticks_;
  WorldRandom random_;
  WorldRandom outages_;
  double outage_begins_s_;
};

// The ground station of a simulated run: heartbeat, arm, run, drive commands up; everything that
// comes down is logged.
//
// The log is `candump -L` text, so that can-utils, Wireshark and python-can read it as it is.

/// What the ground station sends once the robot runs, for the algorithm "drive".
struct DriveCommand {
  double speed_m_per_s = 0.0;
  double yaw_rate_deg_per_s = 0.0;
  bool operator==(const DriveCommand&) const = default;
};

/// Parameters that the ground station sets while the robot runs, as `screed param set` does.
struct ParameterChanges {
  double at_s = 0.0;  ///< none before
  struct Value {
    uint8_t number;
    int16_t value;
  };
  std::vector<Value> values;
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

  /// Commands this from now on: at once where it is something new, and then as often as a drive
  /// that it began with.
  void drive(const std::optional<DriveCommand>& command) {
    if (command == drive_) return;
    drive_ = command;
    drive_is_new_ = true;
  }
  /// Sets these parameters from their time on: one after the other, each again until the robot has
  /// taken it. The last call counts.
  void change(const ParameterChanges& changes) { changes_ = changes; }
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
  void add_change(std::vector<uint8_t>& lines);
  void handle_answer(const message::CommandAck& answer);
  void add_frame(CanFrame frame, uint8_t& counter, std::vector<uint8_t>& lines);
  static void add_line(const CanFrame& frame, std::vector<uint8_t>& lines);

  bool arm_;
  std::optional<DriveCommand> drive_;
  bool drive_is_new_ = false;
  ParameterChanges changes_;  ///< those that are left
  uint8_t stage_counter_ = 0;
  uint8_t commit_ = 0;  ///< the freshness of the command that was to set the first of them
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

// The ground end of the radio: the simulated ground station, and programs outside that listen and
// speak beside it.
//
// A program that sends heartbeats is a ground station; from its first one the simulated station is
// silent for good, since two stations would hide each other's loss from the robot.

class GroundEnd {
 public:
  /// `port` may be null; it must outlive this.
  explicit GroundEnd(GroundPort* port) : port_(port) {}

  /// One control tick: what is to be said goes into the uplink, what has come down is taken out.
  void tick(uint64_t now_us, GroundStation& station, RadioLink& uplink, RadioLink& downlink);

  /// A program outside has taken over.
  bool handed_over() const { return handed_over_; }

 private:
  void listen(std::span<const uint8_t> bytes);

  GroundPort* port_;
  SlcanParser outside_;
  bool handed_over_ = false;
};

}  // namespace screed
