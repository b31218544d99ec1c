// A person drives: takes the robot over from its algorithm, moves it as told, hands it back, with
// the same signed commands and heartbeats as any ground station's.
//
// Nothing is sent before begin() or the first order, so that a robot that is only watched is not
// disturbed. pump() does what is due and waits for nothing else.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "firmware/robot/supervisor.h"
#include "host_sim/ground_station/link/command_session.h"
#include "host_sim/ground_station/link/link.h"
#include "host_sim/ground_station/station/ground_station.h"
#include "host_sim/ground_station/telemetry/latest_telemetry.h"

namespace screed {

struct PilotOptions {
  CommandKey key = test_key();
  /// In force, a LevelingAlgorithm: handed back to. Nothing: what the robot first says.
  std::optional<int> algorithm;
  std::function<uint64_t()> clock;  ///< microseconds, rising
  /// Told of every frame that arrives once the pilot has begun.
  std::function<void(const LinkFrame&)> on_frame;
};

class RobotPilot {
 public:
  /// The link must outlive this.
  RobotPilot(Link& link, PilotOptions options);

  /// Is the robot's ground station from now on.
  void begin();
  bool begun() const { return session_.has_value(); }
  /// What a frame of the robot tells. Before begin() frames are given to this; then they arrive
  /// over the link.
  void note_frame(const CanFrame& frame);

  /// The robot is to be stopped, set to follow the ground station, started, and to move like this.
  /// After an emergency stop or another fault nothing moves before clear_fault().
  void drive(const DriveCommand& command);
  /// The algorithm drives again.
  void hand_back();
  /// The robot is to stand, disarmed, with its algorithm in force again.
  void release();
  /// That is so; also where nothing was ever taken over.
  bool released() const;
  /// Stops the robot at once, whoever drives; needs no key and no taking over. Repeated until the
  /// robot says that it has stopped, since the radio loses packets.
  void emergency_stop();
  /// Clears a latched fault whose cause is gone, and starts the robot again. Only after drive() or
  /// emergency_stop().
  void clear_fault();

  /// Takes what arrives, at most `wait` long, and sends what is due.
  void pump(std::chrono::milliseconds wait);

  /// The person drives, or is about to.
  bool drives() const;
  /// The robot follows the person's commands.
  bool in_control() const;
  /// The algorithm that was handed back to runs again, or nothing was ever taken over.
  bool handed_back() const;
  /// As the robot says.
  std::optional<uint8_t> reported_algorithm() const { return reported_algorithm_; }
  /// What is going on, where it is not simply that the person drives; else empty.
  std::string description() const;

 private:
  enum class Step : uint8_t { kNone, kClear, kDisarm, kAlgorithm, kArm, kRun, kDrive };

  /// Starts the command that comes next on the way to what is wanted.
  void next_command();
  void start(Step step, CommandOp op, uint32_t argument = 0);
  void finish_command(const std::optional<CommandAnswer>& answer);

  Link& link_;
  PilotOptions options_;
  std::optional<int> first_algorithm_;
  std::optional<int> algorithm_;  ///< in force
  std::optional<int> wanted_;     ///< algorithm; nothing before the person takes over
  DriveCommand command_;
  bool rests_ = false;  ///< disarmed is where it is to stay
  bool clear_ = false;
  bool stopping_ = false;  ///< an emergency stop that the robot has not confirmed
  uint64_t next_stop_us_ = 0;
  uint64_t confirmed_from_us_ = 0;  ///< a heartbeat from then on confirms it
  std::optional<CommandSession> session_;
  std::optional<RobotState> state_;
  bool emergency_stopped_ = false;             ///< as the robot says
  std::optional<uint8_t> reported_algorithm_;  ///< likewise
  Step step_ = Step::kNone;
  std::optional<uint32_t> sent_;  ///< argument of the drive command since the robot was started
  uint64_t next_command_us_ = 0;
  std::string refusal_;
  LatestTelemetry said_;  ///< by the robot
};

}  // namespace screed
