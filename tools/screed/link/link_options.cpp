// The options of every subcommand that talks to a robot.
#include "tools/screed/link/link_options.h"

#include "host_sim/core/errors.h"
#include "host_sim/ground_station/link/can_link.h"
#include "host_sim/ground_station/link/serial_link.h"

namespace screed {

void add_link_options(CLI::App& command, LinkArguments& arguments) {
  command.add_option("--port", arguments.port, "serial port of the radio module: /dev/ttyUSB0");
  command.add_option("--can", arguments.can, "CAN interface: slcan0, vcan0");
  command.add_option("--pty", arguments.pty, "virtual serial port that screed sim --pty offers");
  command.add_option("--baud", arguments.baud, "of the serial port; 57600 by default");
  command
      .add_option("--api", arguments.api,
                  "the module is in API mode (parameter AP): 1 plain, 2 escaped; 0: transparent")
      ->check(CLI::IsMember({0, 1, 2}));
}

void add_key_option(CLI::App& command, LinkArguments& arguments) {
  command.add_option("--key", arguments.key,
                     "file with the robot's command key; by default the test key, which every "
                     "simulated robot has");
}

std::unique_ptr<Link> open_link(const LinkArguments& arguments) {
  const int chosen = int{arguments.port.has_value()} + int{arguments.can.has_value()} +
                     int{arguments.pty.has_value()};
  if (chosen != 1) throw InputError("name one link: --port DEVICE, --can INTERFACE or --pty LINK");
  if (arguments.can.has_value()) return std::make_unique<CanLink>(*arguments.can);
  SerialOptions options;
  options.baud = arguments.baud;
  if (arguments.api != 0) options.api = static_cast<XbeeApiMode>(arguments.api);
  return std::make_unique<SerialLink>(arguments.port.value_or(arguments.pty.value_or("")), options);
}

CommandKey command_key(const LinkArguments& arguments) {
  return arguments.key.has_value() ? read_key_file(*arguments.key) : test_key();
}

}  // namespace screed
