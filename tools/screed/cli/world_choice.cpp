// From the user's words to options of a simulation.
#include "tools/screed/cli/world_choice.h"

#include <memory>
#include <optional>

#include "host_sim/core/errors.h"
#include "host_sim/run/world/image_robot.h"
#include "host_sim/run/world/world_setup.h"
#include "host_sim/standin/standin_plant.h"
#include "nn/model/model_file.h"
#include "nn/surrogate/surrogate_plant.h"
#include "nn/terrain/terrain_network.h"

namespace screed {
namespace {

EnvironmentFactory networks_world(const WorldChoice& choice) {
  const auto model = std::make_shared<const nn::Model>(nn::read_model(*choice.model));
  std::optional<nn::TerrainNetwork> ground;
  if (choice.terrain_net.has_value()) ground = nn::read_terrain_network(*choice.terrain_net);
  return [model, ground](HeightField terrain, const Assembly& robot, const PlantOptions& plant) {
    if (ground.has_value() && plant.vehicle.tracks) {
      throw InputError("--terrain-net knows wheels alone: [vehicle] tracks = false");
    }
    auto world = std::make_unique<nn::SurrogatePlant>(std::move(terrain), robot, plant, *model);
    if (ground.has_value()) world->change_ground_by(ground->change(robot));
    return world;
  };
}

}  // namespace

void choose_world(const WorldChoice& choice, SimulationOptions& options) {
  if (choice.board.has_value()) options.board = *choice.board;
  if (choice.hal == "mcu") {
    options.image = choice.elf.value_or(default_image(options.board));
  } else if (choice.elf.has_value()) {
    throw InputError("--elf needs --hal mcu");
  } else if (choice.gdb_port.has_value()) {
    throw InputError("--gdb needs --hal mcu");
  }
  options.gdb_port = choice.gdb_port;
  if (choice.model.has_value() && choice.hal != "surrogate") {
    throw InputError("--model needs --hal surrogate");
  }
  if (choice.model.has_value()) {
    options.environment = networks_world(choice);
  } else if (choice.terrain_net.has_value()) {
    throw InputError("--terrain-net needs --hal surrogate with --model");
  } else if (choice.hal == "surrogate") {
    options.environment = stand_in_environment();
    options.least_cell_m = kStandInCell_m;
  }
}

}  // namespace screed
