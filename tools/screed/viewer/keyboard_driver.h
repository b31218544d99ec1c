// The user at the keyboard or gamepad as the robot's ground station: takes over from the simulated
// one, over the same radio, with the same signed commands and heartbeats as `screed monitor` sends.
//
// Nothing is sent before the user takes over, so that a run that is only watched is the run that
// nobody watched. What is sent is part of the recorded samples, as from any ground station.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware/robot/supervisor.h"
#include "host_sim/ground_station/link/command_session.h"
#include "host_sim/ground_station/link/link.h"
#include "host_sim/ground_station/station/ground_port.h"
#include "host_sim/ground_station/station/ground_station.h"
#include "host_sim/ground_station/telemetry/latest_telemetry.h"
#include "tools/screed/viewer/subtitle.h"

namespace screed::viewer {

class KeyboardDriver : public GroundPort, private Link {
 public:
  /// `algorithm`: the one in force, a LevelingAlgorithm. `beside`: another port at the same end of
  /// the radio; may be null, must outlive this.
  KeyboardDriver(const CommandKey& key, int algorithm, GroundPort* beside = nullptr);

  /// The robot is to be stopped, set to follow the ground station, started, and to move like this.
  /// After an emergency stop or another fault nothing moves before clear_fault().
  void drive(const DriveCommand& command, bool gamepad = false);
  /// The algorithm drives again.
  void hand_back();
  /// Stops the robot at once, whoever drives; needs no key and no taking over. Repeated until the
  /// robot says that it has stopped, since the radio loses packets.
  void emergency_stop();
  /// Clears a latched fault whose cause is gone, and starts the robot again. Only after drive() or
  /// emergency_stop().
  void clear_fault();

  bool drives() const;
  /// One line for the user; empty while there is nothing to say.
  std::string description() const;
  /// Who moves the robot, as far as the radio tells.
  Driver driver() const;

  void send(std::span<const uint8_t> bytes) override;
  std::vector<uint8_t> receive() override;

 private:
  void receive(std::chrono::milliseconds wait, std::vector<LinkFrame>& frames) override;
  bool send(const CanFrame& frame) override;
  const LinkStatus& status() const override { return status_; }
  const std::string& name() const override { return name_; }

  void begin();
  /// What every frame from the robot tells, session or not.
  void note_frame(const CanFrame& frame);
  void listen_beside(std::span<const uint8_t> bytes);
  /// Starts the command that comes next on the way to what is wanted.
  void next_command();
  void finish_command(const std::optional<CommandAnswer>& answer);

  enum class Step : uint8_t { kNone, kClear, kDisarm, kAlgorithm, kArm, kRun, kDrive };
  void start(Step step, CommandOp op, uint32_t argument = 0);

  CommandKey key_;
  int first_algorithm_;
  int algorithm_;  ///< in force
  GroundPort* beside_;
  std::optional<int> wanted_;  ///< algorithm; nothing before the user takes over
  DriveCommand command_;
  bool gamepad_ = false;
  bool clear_ = false;
  bool stopping_ = false;  ///< an emergency stop that the robot has not confirmed
  uint64_t next_stop_tick_ = 0;
  uint64_t confirmed_from_tick_ = 0;  ///< a heartbeat from then on confirms it
  std::optional<CommandSession> session_;
  RobotState state_ = RobotState::kDisarmed;
  bool emergency_stopped_ = false;  ///< as the robot says
  uint8_t reported_algorithm_;      ///< likewise
  bool external_ = false;           ///< another program sends heartbeats
  Step step_ = Step::kNone;
  DriveCommand sent_;
  bool command_is_sent_ = false;
  uint64_t ticks_ = 0;
  uint64_t next_command_tick_ = 0;
  std::string refusal_;
  LatestTelemetry said_;  ///< by the robot

  SlcanParser parser_;
  SlcanParser beside_parser_;
  std::vector<LinkFrame> arrived_;
  std::vector<uint8_t> to_send_;
  LinkStatus status_;
  std::string name_ = "keyboard";
};

}  // namespace screed::viewer
