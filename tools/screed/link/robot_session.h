// One robot at the other end of a link, for subcommands that ask it something and end: meets the
// robot, sends commands, says the answers.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "host_sim/ground_station/link/command_session.h"
#include "host_sim/ground_station/link/robot_history.h"
#include "tools/screed/link/link_options.h"

namespace screed {

/// Why no heartbeat of the session's robot was heard: nothing was, or another robot.
std::string not_heard_text(const FleetView& fleet, const CommandSession& session);

class RobotSession {
 public:
  /// Opens the link; from now on Ctrl-C ends what waits. Throws as open_link().
  RobotSession(const LinkArguments& arguments, const CommandKey& key);
  RobotSession(const RobotSession&) = delete;
  RobotSession& operator=(const RobotSession&) = delete;

  // Ctrl-C ends all that waits for the robot by TaskStopped.

  /// Waits until the robot is heard, and hears this ground station. Throws RunError.
  void meet();
  /// The robot's node; nothing before it was heard.
  std::optional<int> node() const;

  /// Why a command was not done: "no answer", or the robot's reason; empty when it was. Asks the
  /// robot for the limits that it is about.
  std::string reason(const std::optional<CommandAnswer>& answer);
  /// Prints "WHAT: done", or why not; true when it is done.
  bool say(const std::string& what, const std::optional<CommandAnswer>& answer);

  /// The value that the robot has. Throws RunError with its reason when it gives none.
  int32_t read_parameter(uint16_t index);

  /// Sends the emergency stop until a robot says that it has stopped. Nothing: none did.
  std::optional<RobotKey> emergency_stop();

  /// Stays the robot's ground station until interrupted.
  void hold();

  CommandSession& commands() { return session_; }
  const std::string& link_name() const { return link_->name(); }

 private:
  std::unique_ptr<Link> link_;
  FleetView fleet_;
  CommandSession session_;
};

}  // namespace screed
