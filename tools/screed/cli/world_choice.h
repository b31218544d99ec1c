// How the firmware of a run is executed and what stands for physics, for the commands that run
// experiments.
#pragma once

#include <optional>
#include <string>

#include "host_sim/run/simulation/simulation.h"

namespace screed {

struct WorldChoice {
  std::string hal = "native";  ///< native, mcu or surrogate
  std::optional<std::string> board;
  std::optional<std::string> elf;          ///< for mcu; else the one of `make firmware`
  std::optional<int> gdb_port;             ///< for mcu: where the image waits for a debugger
  std::optional<std::string> model;        ///< for surrogate: of a network in place of the stand-in
  std::optional<std::string> terrain_net;  ///< with model: what changes the ground
};

/// Sets board, image and environment. Throws InputError for an unknown board, a model that cannot
/// be read, and what needs another hal.
void choose_world(const WorldChoice& choice, SimulationOptions& options);

}  // namespace screed
