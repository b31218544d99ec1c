// The options of every subcommand that talks to a robot.
#include "tools/screed/link/link_options.h"

#include "host_sim/core/errors.h"
#include "host_sim/ground_station/link/can_link.h"
#include "host_sim/ground_station/link/serial_link.h"
#include "tools/screed/cli/number_option.h"

namespace screed {

void add_link_options(CLI::App& command, LinkArguments& arguments) {
  command.add_option("--port", arguments.port,
                     "Serial port of the radio module, e.g. /dev/ttyUSB0");
  command.add_option("--can", arguments.can, "CAN interface, e.g. slcan0 or vcan0");
  command.add_option("--pty", arguments.pty, "Virtual serial port offered by screed sim --pty");
  add_number(command, "--baud", arguments.baud, "Baud rate of the serial port (default: 57600)",
             {9600, 230400});
  add_number(command, "--api", arguments.api,
             "API mode of the radio module (parameter AP): 1 plain, 2 escaped; 0: transparent",
             {0, 2});
}

void add_key_option(CLI::App& command, LinkArguments& arguments) {
  command.add_option(
      "--key", arguments.key,
      "File with the robot's command key (default: the test key of simulated robots)");
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
