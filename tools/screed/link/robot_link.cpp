// The options of every subcommand that talks to a robot, the remembered link, and a robot at its
// end.
#include "tools/screed/link/robot_link.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <sstream>

#include "firmware/parameters/parameters.h"
#include "host_sim/core/atomic_file.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/ini_file.h"
#include "host_sim/ground_station/link/can_link.h"
#include "host_sim/ground_station/link/serial_link.h"
#include "host_sim/ground_station/link/shared_link.h"
#include "host_sim/ground_station/station/key_file.h"
#include "host_sim/ground_station/telemetry/arming.h"
#include "tools/screed/cli/interrupt.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/link/named_parameters.h"

namespace screed {
namespace {

/// As the user meant them: a command line that names a link says all; one that names none has the
/// rest from what is remembered.
LinkArguments with_remembered(const LinkArguments& arguments) {
  if (links_named(arguments) > 0) return arguments;
  LinkArguments all = read_remembered_link(remembered_link_file());
  if (arguments.baud.has_value()) all.baud = arguments.baud;
  if (arguments.api.has_value()) all.api = arguments.api;
  if (arguments.key.has_value()) all.key = arguments.key;
  return all;
}

std::unique_ptr<Link> open(const LinkArguments& link) {
  if (link.can.has_value()) return std::make_unique<CanLink>(*link.can);
  SerialOptions options;
  if (link.baud.has_value()) options.baud = *link.baud;
  if (link.api.value_or(0) != 0) options.api = static_cast<XbeeApiMode>(*link.api);
  const std::string& device = link.port.has_value() ? *link.port : *link.pty;
  return std::make_unique<SharedLink>(
      device, [device, options] { return std::make_unique<SerialLink>(device, options); });
}

}  // namespace

int links_named(const LinkArguments& arguments) {
  return int{arguments.port.has_value()} + int{arguments.can.has_value()} +
         int{arguments.pty.has_value()};
}

void add_link_options(Command& command, LinkArguments& arguments) {
  command
      .add_option("--port", arguments.port, "Serial port of the radio module, e.g. /dev/ttyUSB0")
      ->type_name("DEVICE");
  command.add_option("--can", arguments.can, "CAN interface, e.g. slcan0 or vcan0")
      ->type_name("INTERFACE");
  command.add_option("--pty", arguments.pty, "Virtual serial port offered by screed sim --pty")
      ->type_name("DEVICE");
  add_number(command, "--baud", arguments.baud, "Baud rate of the serial port (default: 57600)",
             kBaudRange);
  add_number(command, "--api", arguments.api,
             "API mode of the radio module (parameter AP): 1 plain, 2 escaped; 0: transparent "
             "(default: 0)",
             kApiRange);
  command.add_flag("--remember", arguments.remember,
                   "Remember this link and the key file for calls that name no link");
}

void add_key_option(Command& command, LinkArguments& arguments) {
  command
      .add_option("--key", arguments.key,
                  "File with the robot's command key (default: the remembered link's, or the test "
                  "key of simulated robots)")
      ->type_name("FILE");
}

std::unique_ptr<Link> open_link(const LinkArguments& arguments) {
  const LinkArguments link = with_remembered(arguments);
  if (links_named(link) != 1) {
    throw InputError(
        "name one link: --port DEVICE, --can INTERFACE or --pty DEVICE; --remember keeps it for "
        "later calls");
  }
  if (links_named(arguments) == 0) {
    std::cerr << "using " << remembered_link_text(link) << ", remembered in "
              << remembered_link_file().string() << "\n";
  }
  std::unique_ptr<Link> opened = open(link);
  if (arguments.remember) {
    if (link.key.has_value()) read_key_file(*link.key);
    write_remembered_link(remembered_link_file(), link);
    std::cerr << remembered_link_text(link) << ": remembered in " << remembered_link_file().string()
              << "\n";
  }
  return opened;
}

CommandKey command_key(const LinkArguments& arguments) {
  const LinkArguments link = with_remembered(arguments);
  if (!link.key.has_value()) return test_key();
  try {
    return read_key_file(*link.key);
  } catch (const InputError& error) {
    if (arguments.key.has_value()) throw;
    throw InputError(std::string(error.what()) + " (key remembered in " +
                     remembered_link_file().string() + ")");
  }
}

// ---- the remembered link ----

namespace {

namespace fs = std::filesystem;

/// The keys of the file.
struct TextKey {
  const char* name;
  std::optional<std::string> LinkArguments::*value;
  bool is_file;
};
constexpr TextKey kTexts[] = {
    {"port", &LinkArguments::port, true},
    {"can", &LinkArguments::can, false},
    {"pty", &LinkArguments::pty, true},
    {"key", &LinkArguments::key, true},
};
struct NumberKey {
  const char* name;
  std::optional<int> LinkArguments::*value;
  const NumberRange& range;
};
constexpr NumberKey kNumbers[] = {
    {"baud", &LinkArguments::baud, kBaudRange},
    {"api", &LinkArguments::api, kApiRange},
};

constexpr char kAllowedKeys[] = "port, can, pty, baud, api and key in [link]";

/// What is allowed in place of the entry; nothing: it is taken.
std::optional<std::string> take(LinkArguments& link, const IniEntry& entry) {
  if (entry.section != "link" || entry.value.empty()) return kAllowedKeys;
  for (const TextKey& key : kTexts) {
    if (entry.key != key.name) continue;
    link.*key.value = entry.value;
    return std::nullopt;
  }
  for (const NumberKey& key : kNumbers) {
    if (entry.key != key.name) continue;
    const std::optional<int> number = finite_number<int>(entry.value);
    if (!number.has_value() || !key.range.contains(*number)) {
      return "whole numbers " + plain_text(key.range.low) + " to " + plain_text(key.range.high);
    }
    link.*key.value = number;
    return std::nullopt;
  }
  return kAllowedKeys;
}

constexpr char kWrittenAnew[] = "; screed writes the file anew with --remember";

}  // namespace

fs::path remembered_link_file() {
  const char* const config = std::getenv("XDG_CONFIG_HOME");
  const char* const home = std::getenv("HOME");
  const fs::path folder = config != nullptr ? config : "";
  if (folder.is_absolute()) return folder / "screed" / "link.ini";
  if (home == nullptr || *home == '\0') return {};
  return fs::path(home) / ".config" / "screed" / "link.ini";
}

LinkArguments read_remembered_link(const fs::path& file) {
  LinkArguments link;
  std::error_code error;
  if (file.empty() || !fs::exists(file, error)) return link;
  std::ifstream input(file);
  std::stringstream text;
  text << input.rdbuf();
  if (!input) throw InputError(file.string() + ": cannot be read");
  for (const IniEntry& entry : read_ini_text(text.str(), file.string())) {
    const std::optional<std::string> allowed = take(link, entry);
    if (!allowed.has_value()) continue;
    std::string message = file.string();
    message += ":" + std::to_string(entry.line) + ": '" + entry.key + " = " + entry.value;
    throw InputError(message + "' is not allowed; allowed are " + *allowed + kWrittenAnew);
  }
  if (links_named(link) > 1) {
    throw InputError(file.string() + ": names several links; allowed is one of port, can and pty" +
                     kWrittenAnew);
  }
  return link;
}

void write_remembered_link(const fs::path& file, const LinkArguments& link) {
  if (file.empty()) throw InputError("--remember: neither XDG_CONFIG_HOME nor HOME is set");
  std::string text =
      "# Used by calls of screed that name no link; written by --remember.\n[link]\n";
  for (const TextKey& key : kTexts) {
    const std::optional<std::string>& value = link.*key.value;
    if (!value.has_value()) continue;
    text += key.name;
    text +=
        " = " + (key.is_file ? fs::absolute(*value).lexically_normal().string() : *value) + "\n";
  }
  for (const NumberKey& key : kNumbers) {
    if (!(link.*key.value).has_value()) continue;
    text += key.name;
    text += " = " + std::to_string(*(link.*key.value)) + "\n";
  }
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  write_file(file, text);
}

std::string remembered_link_text(const LinkArguments& link) {
  std::string text;
  for (const TextKey& key : kTexts) {
    const std::optional<std::string>& value = link.*key.value;
    if (!value.has_value()) continue;
    text += text.empty() ? "" : ", ";
    text += key.name;
    text += " " + *value;
  }
  return text;
}

// ---- one robot at the other end ----

namespace {

constexpr std::chrono::milliseconds kSessionPump{20};
constexpr uint64_t kAnswerTimeout_us = 3'000'000;
constexpr uint64_t kStopPeriod_us = 200'000;
constexpr char kNoAnswer[] = "no answer";

}  // namespace

std::string not_heard_text(const FleetView& fleet, const CommandSession& session,
                           const Link& link) {
  if (fleet.robots().empty()) {
    const std::string& hint = link.status().hint;
    return hint.empty() ? "no robot is heard" : "no robot is heard: " + hint;
  }
  return fleet.robots().begin()->first.text() + " is heard, but the key is that of robot " +
         std::to_string(session.node()) +
         "; --key names another, make flash NODE=N gives a robot its number";
}

RobotSession::RobotSession(const LinkArguments& arguments, const CommandKey& key)
    : link_(open_link(arguments)),
      session_(*link_, {key,
                        true,
                        [this](const LinkFrame& frame) { fleet_.add_frame(frame); },
                        {},
                        [] { stop_if_interrupted("waiting for the robot's answer"); }}) {
  catch_interrupts();
}

void RobotSession::meet() {
  const uint64_t end_us = wall_clock_us() + kAnswerTimeout_us;
  const auto heard = [this] {
    const RobotHistory* const robot = fleet_.robot(session_.node());
    return robot != nullptr && robot->value("heartbeat.link_alive").value_or(0.0) != 0.0;
  };
  while (wall_clock_us() < end_us && !(session_.ready() && heard())) {
    stop_if_interrupted("waiting for the robot");
    session_.pump(kSessionPump);
  }
  if (!link_->status().up) throw RunError(link_->name() + ": " + link_->status().text);
  if (!session_.ready())
    throw RunError(link_->name() + ": " + not_heard_text(fleet_, session_, *link_));
}

std::optional<int> RobotSession::node() const {
  if (fleet_.robot(session_.node()) == nullptr) return std::nullopt;
  return session_.node();
}

std::string RobotSession::reason(const std::optional<CommandAnswer>& answer) {
  const RobotHistory* const view = fleet_.robot(session_.node());
  if (!answer.has_value() || view == nullptr) return kNoAnswer;
  const LatestTelemetry& robot = view->latest();
  if (answer->result == static_cast<uint8_t>(message::CommandAckResult::kFaultPresent)) {
    // The sentences name the robot's own limits.
    std::optional<CommandAnswer> read;
    for (const std::string_view limit : limits_to_read(answer->detail, robot))
      session_.read_parameter(parameter_index(std::string(limit)), read);
  }
  return refusal_text(*answer, robot, wall_clock_us());
}

bool RobotSession::say(const std::string& what, const std::optional<CommandAnswer>& answer) {
  const std::string why_not = reason(answer);
  const char* const refused = why_not.empty() ? "done" : why_not == kNoAnswer ? "" : "refused: ";
  std::cout << what << ": " << refused << why_not << std::endl;
  return why_not.empty();
}

int32_t RobotSession::read_parameter(uint16_t index) {
  std::optional<CommandAnswer> answer;
  const std::optional<int32_t> value = session_.read_parameter(index, answer);
  if (!value.has_value())
    throw RunError(std::string(kParameterTable[index].name) + ": " + reason(answer));
  return *value;
}

std::optional<RobotKey> RobotSession::emergency_stop() {
  // Sent before anything is heard: the robot may be deaf to the ground but not the ground to it.
  session_.emergency_stop();
  const uint64_t end_us = wall_clock_us() + kAnswerTimeout_us;
  uint64_t again_us = wall_clock_us() + kStopPeriod_us;
  while (!interrupted() && wall_clock_us() < end_us) {
    session_.pump(kSessionPump);
    for (const auto& [key, robot] : fleet_.robots()) {
      if (robot.value("heartbeat.emergency_stop").value_or(0.0) == 0.0) continue;
      return key;
    }
    if (wall_clock_us() < again_us) continue;
    session_.emergency_stop();
    again_us += kStopPeriod_us;
  }
  return std::nullopt;
}

void RobotSession::hold() {
  std::cerr << "holding the link; end with Ctrl-C, and the robot stops\n";
  while (!interrupted()) session_.pump(kSessionPump);
}

}  // namespace screed
