// `screed key`: makes the key that commands are signed with, and gives it to a robot over USB.
#pragma once

#include <functional>
#include <string>

#include "host_sim/ground_station/station/command_key.h"

namespace screed {

/// A key nobody else has, from the kernel's random numbers. Throws RunError.
CommandKey random_key(uint8_t robot_id);

/// Sends a line to the robot's console and returns the line it answers with; empty when it does
/// not.
using AskConsole = std::function<std::string(const std::string& line)>;

/// Gives the key; called once a robot's console has answered.
using GetKey = std::function<CommandKey()>;

/// Stores the key on the robot behind `ask` and restarts it. The key is asked for and sent only
/// when a robot's console has answered before: not over a radio module by mistake. Returns false
/// when the robot has the key but cannot restart now. Throws RunError.
bool provision_key(const AskConsole& ask, const std::string& port, const GetKey& get_key);

/// Opens the port and does that. Throws RunError, InputError for a port that does not exist.
bool provision_key(const std::string& port, const GetKey& get_key);

}  // namespace screed
