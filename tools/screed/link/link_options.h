// The options of every subcommand that talks to a robot: which link, which key.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>

#include "host_sim/ground_station/link/link.h"
#include "host_sim/ground_station/station/command_key.h"

namespace screed {

struct LinkArguments {
  std::optional<std::string> port;
  std::optional<std::string> can;
  std::optional<std::string> pty;
  int baud = 57600;
  int api = 0;
  std::optional<std::string> key;
};

void add_link_options(CLI::App& command, LinkArguments& arguments);
void add_key_option(CLI::App& command, LinkArguments& arguments);

/// Opens the one link that was asked for. Throws InputError when it is none or several, and what
/// the link itself throws.
std::unique_ptr<Link> open_link(const LinkArguments& arguments);

/// The key of --key; without it the test key that simulated robots have.
CommandKey command_key(const LinkArguments& arguments);

}  // namespace screed
