// The options of every subcommand that talks to a robot: which link, which key.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include "tools/command_line/command.h"

#include "host_sim/ground_station/link/link.h"
#include "host_sim/ground_station/station/command_key.h"
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

/// Opens the one link that was asked for, or else the remembered one (remembered_link.h), which it
/// says on standard error; with --remember it is remembered once it is open. Throws InputError when
/// it is none or several, and what the link itself throws.
std::unique_ptr<Link> open_link(const LinkArguments& arguments);

/// The key of --key; without it that of the remembered link, where that is used; else the test key
/// that simulated robots have.
CommandKey command_key(const LinkArguments& arguments);

}  // namespace screed
