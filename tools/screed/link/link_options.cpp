// The options of every subcommand that talks to a robot.
#include "tools/screed/link/link_options.h"

#include <iostream>

#include "host_sim/core/errors.h"
#include "host_sim/ground_station/link/can_link.h"
#include "host_sim/ground_station/link/serial_link.h"
#include "host_sim/ground_station/link/shared_link.h"
#include "host_sim/ground_station/station/key_file.h"
#include "tools/screed/link/remembered_link.h"

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

}  // namespace screed
