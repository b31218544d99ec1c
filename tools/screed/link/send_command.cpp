// `screed send`: one command to a robot, and its answer in words. Exit codes: 0 done, 1 refused or
// no answer, 2 wrong input.
#include <cmath>
#include <memory>
#include <string>

#include "tools/screed/cli/command.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/link/robot_session.h"

namespace screed {
namespace {

struct SendArguments {
  LinkArguments link;
  bool hold = false;
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

int send_command(const SendArguments& arguments, CommandOp op, uint32_t argument,
                 const std::string& name) {
  RobotSession robot(arguments.link, command_key(arguments.link));
  robot.meet();
  if (!robot.say(name, robot.commands().run(op, argument))) return 1;
  if (arguments.hold) robot.hold();
  return 0;
}

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
  const auto on = [&program](CLI::App* what, const std::function<int()>& act) {
    what->fallthrough();
    what->callback([&program, act] { program.action = act; });
  };
  for (const SimpleCommand& simple : kSimpleCommands) {
    on(command->add_subcommand(simple.name, simple.meaning),
       [arguments, simple] { return send_command(*arguments, simple.op, 0, simple.name); });
  }
  on(command->add_subcommand("estop", "Stop immediately (emergency stop); needs no key"),
     [arguments] { return RobotSession(arguments->link, test_key()).emergency_stop() ? 0 : 1; });

  CLI::App* drive = command->add_subcommand("drive", "Drive, with the algorithm \"drive\" running");
  add_number(*drive, "SPEED", arguments->speed_m_per_s, "Speed [m/s]", {-2.0, 2.0})->required();
  add_number(*drive, "YAW_RATE", arguments->yaw_rate_deg_per_s,
             "Yaw rate, counter-clockwise [deg/s]", {-200.0, 200.0});
  on(drive, [arguments] {
    const DriveArgument argument = {
        static_cast<int16_t>(std::lround(arguments->speed_m_per_s * 1000.0)),
        static_cast<int16_t>(std::lround(arguments->yaw_rate_deg_per_s * 10.0))};
    uint8_t bytes[3];
    put_drive_argument(bytes, argument);
    return send_command(*arguments, CommandOp::kDrive,
                        static_cast<uint32_t>(bytes[0] | bytes[1] << 8 | bytes[2] << 16), "drive");
  });
}

}  // namespace screed
