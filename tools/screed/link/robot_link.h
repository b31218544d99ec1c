// What every subcommand that talks to a robot has: the options which link and which key, the
// remembered link, and a session with one robot at the other end.
//
// The link and the key file that calls use that name no link are an INI file of the user, written
// by
// --remember:
//
//   [link]
//   port = /dev/ttyUSB0      or can = slcan0, or pty = /home/ada/radio
//   baud = 57600
//   api = 0
//   key = /home/ada/robot.key
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "host_sim/ground_station/link/command_session.h"
#include "host_sim/ground_station/link/link.h"
#include "host_sim/ground_station/link/robot_history.h"
#include "host_sim/ground_station/station/command_key.h"
#include "tools/command_line/command.h"
#include "tools/screed/cli/number_option.h"

namespace screed {

/// Of --baud [Bd] and --api, and of the same keys of the remembered link.
inline constexpr NumberRange kBaudRange{9600, 230400};
inline constexpr NumberRange kApiRange{0, 2};

struct LinkArguments {
  std::optional<std::string> port;
  std::optional<std::string> can;
  std::optional<std::string> pty;
  std::optional<int> baud;
  std::optional<int> api;
  std::optional<std::string> key;
  bool remember = false;
};

/// How many of port, can and pty are there; one is right.
int links_named(const LinkArguments& arguments);

void add_link_options(Command& command, LinkArguments& arguments);
void add_key_option(Command& command, LinkArguments& arguments);

/// Opens the one link that was asked for, or else the remembered one, which it
/// says on standard error; with --remember it is remembered once it is open. Throws InputError when
/// it is none or several, and what the link itself throws.
std::unique_ptr<Link> open_link(const LinkArguments& arguments);

/// The key of --key; without it that of the remembered link, where that is used; else the test key
/// that simulated robots have.
CommandKey command_key(const LinkArguments& arguments);

/// screed/link.ini in the user's folder for configurations: XDG_CONFIG_HOME, else ~/.config. Empty
/// when neither is known.
std::filesystem::path remembered_link_file();

/// What the file says; nothing where there is no file. Throws InputError with file and line.
LinkArguments read_remembered_link(const std::filesystem::path& file);

/// Replaces the file. Names of files become absolute; the key itself is not written. Throws
/// InputError when `file` is empty, RunError when it cannot be written.
void write_remembered_link(const std::filesystem::path& file, const LinkArguments& link);

/// "port /dev/ttyUSB0, key /home/ada/robot.key".
std::string remembered_link_text(const LinkArguments& link);

/// Why no heartbeat of the session's robot was heard: nothing was, or another robot.
std::string not_heard_text(const FleetView& fleet, const CommandSession& session, const Link& link);

/// One robot at the other end of a link, for subcommands that ask it something and end: meets the
/// robot, sends commands, says the answers.
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
