// `screed send`: one command to a robot, and its answer in words. Exit codes: 0 done, 1 refused or
// no answer, 2 wrong input.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>

#include "firmware/parameters/parameter_table.h"
#include "host_sim/core/errors.h"
#include "host_sim/ground_station/link/command_session.h"
#include "host_sim/ground_station/link/robot_view.h"
#include "host_sim/ground_station/telemetry/arming.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/interrupt.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/cli/parameter_names.h"
#include "tools/screed/link/link_options.h"

namespace screed {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kPump{20};
constexpr uint64_t kAnswerTimeout_us = 3'000'000;

struct SendArguments {
  LinkArguments link;
  bool hold = false;
  std::string name;
  std::string value;
  double speed_m_per_s = 0.0;
  double yaw_rate_deg_per_s = 0.0;
};

struct SimpleCommand {
  const char* name;
  CommandOp op;
  const char* meaning;
};
constexpr SimpleCommand kSimpleCommands[] = {
    {"arm", CommandOp::kArm, "Arm the robot so that it accepts run"},
    {"run", CommandOp::kRun, "Start the leveling algorithm, or resume after a stop"},
    {"stop", CommandOp::kStop, "Ramp down and stop"},
    {"disarm", CommandOp::kDisarm, "Stop and cut the motors' power"},
    {"clear", CommandOp::kClear, "Clear a fault whose cause is gone"},
};

/// One robot at the other end of a link.
class Sender {
 public:
  explicit Sender(const SendArguments& arguments)
      : hold_(arguments.hold),
        link_(open_link(arguments.link)),
        session_(*link_, {command_key(arguments.link),
                          true,
                          [this](const LinkFrame& frame) { fleet_.add_frame(frame); },
                          {}}) {}

  int command(CommandOp op, uint32_t argument, const std::string& name) {
    meet();
    return finish(say(name, session_.run(op, argument)));
  }

  int read_parameters(const std::string& name) {
    meet();
    uint16_t index = 0;
    for (const ParameterInfo& info : kParameterTable) {
      if (name.empty() || name == info.name) {
        std::optional<CommandAnswer> answer;
        const std::optional<int32_t> value = session_.read_parameter(index, answer);
        if (!value.has_value()) {
          say(info.name, answer);
          return 1;
        }
        std::cout << info.name << " = " << *value << (*info.unit == '\0' ? "" : " ") << info.unit
                  << "\n";
      }
      ++index;
    }
    return 0;
  }

  int write_parameter(uint16_t index, int16_t value) {
    meet();
    return finish(say(kParameterTable[index].name, session_.write_parameter(index, value)));
  }

  int emergency_stop() {
    // Sent before anything is heard: the robot may be deaf to the ground but not the ground to it.
    session_.emergency_stop();
    const uint64_t end_us = wall_clock_us() + kAnswerTimeout_us;
    uint64_t again_us = wall_clock_us() + 200'000;
    while (!interrupted() && wall_clock_us() < end_us) {
      session_.pump(kPump);
      for (const auto& [key, robot] : fleet_.robots()) {
        if (robot.value("heartbeat.emergency_stop").value_or(0.0) != 0.0) {
          std::cout << "estop: " << key.text() << " has stopped\n";
          return 0;
        }
      }
      if (wall_clock_us() >= again_us) {
        session_.emergency_stop();
        again_us += 200'000;
      }
    }
    std::cout << "estop: sent, but no robot says that it has stopped\n";
    return 1;
  }

 private:
  /// Waits until the robot is heard, and hears this ground station.
  void meet() {
    const uint64_t end_us = wall_clock_us() + kAnswerTimeout_us;
    const auto heard = [this] {
      return std::any_of(fleet_.robots().begin(), fleet_.robots().end(), [](const auto& robot) {
        return robot.second.value("heartbeat.link_alive").value_or(0.0) != 0.0;
      });
    };
    while (!interrupted() && wall_clock_us() < end_us && !(session_.ready() && heard()))
      session_.pump(kPump);
    if (!link_->status().up) throw RunError(link_->name() + ": " + link_->status().text);
    if (!session_.ready()) throw RunError(link_->name() + ": no robot is heard");
  }

  int say(const std::string& what, const std::optional<CommandAnswer>& answer) {
    std::cout << what << ": " << words(answer) << std::endl;
    return answer.has_value() && answer->done() ? 0 : 1;
  }

  std::string words(const std::optional<CommandAnswer>& answer) {
    if (!answer.has_value() || fleet_.robots().empty()) return "no answer";
    const LatestTelemetry& robot = fleet_.robots().begin()->second.latest();
    if (answer->result == static_cast<uint8_t>(message::CommandAckResult::kFaultPresent)) {
      // The sentences name the robot's own limits.
      std::optional<CommandAnswer> read;
      for (const std::string_view limit : limits_to_read(answer->detail, robot))
        session_.read_parameter(parameter_index(std::string(limit)), read);
    }
    return answer_text(*answer, robot, wall_clock_us());
  }

  /// With --hold this stays the robot's ground station until interrupted.
  int finish(int status) {
    if (status == 0 && hold_) {
      std::cerr << "holding the link; end with Ctrl-C, and the robot stops\n";
      while (!interrupted()) session_.pump(kPump);
    }
    return status;
  }

  bool hold_;
  std::unique_ptr<Link> link_;
  FleetView fleet_;
  CommandSession session_;
};

}  // namespace

void register_send_command(CLI::App& root, Program& program) {
  auto arguments = std::make_shared<SendArguments>();
  CLI::App* command = root.add_subcommand("send", "Send a robot a command and print its answer");
  add_link_options(*command, arguments->link);
  add_key_option(*command, arguments->link);
  command->add_flag("--hold", arguments->hold,
                    "Keep sending heartbeats after the command, until Ctrl-C");
  command->require_subcommand(1);
  command->fallthrough();
  const auto on = [arguments, &program](CLI::App* what, std::function<int(Sender&)> act) {
    what->fallthrough();
    what->callback([arguments, &program, act] {
      program.action = [arguments, act] {
        catch_interrupts();
        Sender sender(*arguments);
        return act(sender);
      };
    });
  };
  for (const SimpleCommand& simple : kSimpleCommands) {
    on(command->add_subcommand(simple.name, simple.meaning),
       [simple](Sender& sender) { return sender.command(simple.op, 0, simple.name); });
  }
  on(command->add_subcommand("estop", "Stop immediately (emergency stop); needs no key"),
     [](Sender& sender) { return sender.emergency_stop(); });

  CLI::App* drive = command->add_subcommand("drive", "Drive, with the algorithm \"drive\" running");
  add_number(*drive, "SPEED", arguments->speed_m_per_s, "Speed [m/s]", {-2.0, 2.0})->required();
  add_number(*drive, "YAW_RATE", arguments->yaw_rate_deg_per_s,
             "Yaw rate, counter-clockwise [deg/s]", {-200.0, 200.0});
  on(drive, [arguments](Sender& sender) {
    const DriveArgument argument = {
        static_cast<int16_t>(std::lround(arguments->speed_m_per_s * 1000.0)),
        static_cast<int16_t>(std::lround(arguments->yaw_rate_deg_per_s * 10.0))};
    uint8_t bytes[3];
    put_drive_argument(bytes, argument);
    return sender.command(CommandOp::kDrive,
                          static_cast<uint32_t>(bytes[0] | bytes[1] << 8 | bytes[2] << 16),
                          "drive");
  });

  CLI::App* param = command->add_subcommand("param", "Read or set parameters");
  param->require_subcommand(1);
  param->fallthrough();
  CLI::App* get = param->add_subcommand("get", "Print a parameter of the robot, or all of them");
  get->add_option("NAME", arguments->name, "Name of the parameter (default: all)");
  on(get, [arguments](Sender& sender) {
    if (!arguments->name.empty()) parameter_index(arguments->name);
    return sender.read_parameters(arguments->name);
  });
  CLI::App* set = param->add_subcommand("set", "Set and store a parameter");
  set->add_option("NAME", arguments->name, "Name of the parameter")->required();
  set->add_option("VALUE", arguments->value, "New value")->required();
  on(set, [arguments](Sender& sender) {
    const uint16_t index = parameter_index(arguments->name);
    return sender.write_parameter(index, parameter_value(index, arguments->value));
  });
}

}  // namespace screed
