// `screed send`: one command to a robot, and its answer in words. Exit codes: 0 done, 1 refused or
// no answer, 2 wrong input, 130 interrupted.
#include <cmath>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include "host_sim/core/json.h"
#include "host_sim/ground_station/telemetry/schema.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/interrupt.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/link/robot_link.h"

namespace screed {
namespace {

struct SendArguments {
  LinkArguments link;
  bool hold = false;
  bool json = false;
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

Json or_null(const auto& value) {
  return value.has_value() ? Json(*value) : Json(nullptr);
}

/// What programs read of a command and its answer.
void print_json(Json sent, RobotSession& robot, const std::optional<CommandAnswer>& answer) {
  const std::string reason = robot.reason(answer);
  sent["robot"] = or_null(robot.node());
  sent["done"] = reason.empty();
  sent["answer"] = answer.has_value()
                       ? Json(find_signal("command_ack.result").signal->text(answer->result))
                       : Json(nullptr);
  sent["reason"] = reason.empty() ? Json(nullptr) : Json(reason);
  std::cout << sent.dump(2) << std::endl;
}

/// `sent`: the command's name and what it was given.
int send_command(const SendArguments& arguments, CommandOp op, uint32_t argument,
                 const Json& sent) {
  RobotSession robot(arguments.link, command_key(arguments.link));
  robot.meet();
  const std::optional<CommandAnswer> answer = robot.commands().run(op, argument);
  if (arguments.json) {
    print_json(sent, robot, answer);
  } else {
    robot.say(sent["command"].text(), answer);
  }
  if (!answer.has_value() || !answer->done()) return 1;
  if (arguments.hold) robot.hold();
  return 0;
}

int send_emergency_stop(const SendArguments& arguments) {
  const std::optional<RobotKey> stopped = RobotSession(arguments.link, test_key()).emergency_stop();
  if (arguments.json) {
    Json json = {{"command", "estop"}};
    json["robot"] = stopped.has_value() ? Json(stopped->node) : Json(nullptr);
    json["done"] = stopped.has_value();
    std::cout << json.dump(2) << std::endl;
  } else {
    std::cout << "estop: "
              << (stopped.has_value() ? stopped->text() + " has stopped"
                                      : "sent, but no robot says that it has stopped")
              << std::endl;
  }
  stop_if_interrupted("waiting for a robot that says it has stopped");
  return stopped.has_value() ? 0 : 1;
}

}  // namespace

void register_send_command(Command& root, Program& program) {
  auto arguments = std::make_shared<SendArguments>();
  Command* command = root.add_subcommand("send", "Send a robot a command and print its answer");
  add_link_options(*command, arguments->link);
  add_key_option(*command, arguments->link);
  command->add_flag("--hold", arguments->hold,
                    "Keep sending heartbeats after the command, until Ctrl-C");
  command->add_flag("--json", arguments->json, "Print command and answer as JSON");
  command->fallthrough();
  const auto on = [&program](Command* what, const std::function<int()>& act) {
    what->fallthrough();
    what->callback([&program, act] { program.action = act; });
  };
  for (const SimpleCommand& simple : kSimpleCommands) {
    on(command->add_subcommand(simple.name, simple.meaning), [arguments, simple] {
      return send_command(*arguments, simple.op, 0, {{"command", simple.name}});
    });
  }
  on(command->add_subcommand("estop", "Stop immediately (emergency stop); needs no key"),
     [arguments] { return send_emergency_stop(*arguments); });

  Command* drive = command->add_subcommand("drive", "Drive, with the algorithm \"drive\" running");
  add_number(*drive, "SPEED", arguments->speed_m_per_s, "Speed [m/s]", {-2.0, 2.0})->required();
  add_number(*drive, "YAW_RATE", arguments->yaw_rate_deg_per_s,
             "Yaw rate, counter-clockwise [deg/s]", {-200.0, 200.0});
  on(drive, [arguments] {
    const DriveArgument argument = {
        static_cast<int16_t>(std::lround(arguments->speed_m_per_s * 1000.0)),
        static_cast<int16_t>(std::lround(arguments->yaw_rate_deg_per_s * 10.0))};
    return send_command(*arguments, CommandOp::kDrive, command_argument(argument),
                        {{"command", "drive"},
                         {"speed_m_per_s", arguments->speed_m_per_s},
                         {"yaw_rate_deg_per_s", arguments->yaw_rate_deg_per_s}});
  });
}

}  // namespace screed
