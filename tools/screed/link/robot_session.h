// One robot at the other end of a link, for subcommands that ask it something and end: meets the
// robot, sends commands, says the answers.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "host_sim/ground_station/link/command_session.h"
#include "host_sim/ground_station/link/robot_view.h"
#include "tools/screed/link/link_options.h"

namespace screed {

class RobotSession {
 public:
  /// Opens the link; from now on Ctrl-C ends what waits. Throws as open_link().
  RobotSession(const LinkArguments& arguments, const CommandKey& key);
  RobotSession(const RobotSession&) = delete;
  RobotSession& operator=(const RobotSession&) = delete;

  /// Waits until the robot is heard, and hears this ground station. Throws RunError.
  void meet();

  /// Prints "WHAT: done", or why not; true when it is done.
  bool say(const std::string& what, const std::optional<CommandAnswer>& answer);

  /// The value that the robot has. Throws RunError with its reason when it gives none.
  int32_t read_parameter(uint16_t index);

  /// Sends the emergency stop until a robot says that it has stopped; says so. False: none did.
  bool emergency_stop();

  /// Stays the robot's ground station until interrupted.
  void hold();

  CommandSession& commands() { return session_; }
  const std::string& link_name() const { return link_->name(); }

 private:
  /// The answer with its reason; asks the robot for the limits that it is about.
  std::string words(const std::optional<CommandAnswer>& answer);

  std::unique_ptr<Link> link_;
  FleetView fleet_;
  CommandSession session_;
};

}  // namespace screed
