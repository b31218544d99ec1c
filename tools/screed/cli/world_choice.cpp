// From the user's words to options of a simulation.
#include "tools/screed/cli/world_choice.h"

#include <filesystem>
#include <memory>

#include "host_sim/core/errors.h"
#include "host_sim/standin/standin_plant.h"
#include "nn/model/model_file.h"
#include "nn/surrogate/default_model.h"
#include "nn/surrogate/surrogate_plant.h"

namespace screed {
namespace {

EnvironmentFactory networks_world(const WorldChoice& choice) {
  const auto model = std::make_shared<const nn::Model>(nn::read_model(*choice.model));
  std::shared_ptr<const nn::BearingCapacityNetwork> bearing;
  if (!choice.no_ruts) {
    bearing = std::make_shared<const nn::BearingCapacityNetwork>(nn::BearingCapacityNetwork::read(
        choice.soil_model.has_value() ? std::filesystem::path(*choice.soil_model)
                                      : nn::default_bearing_capacity_file()));
  }
  return [model, bearing](HeightField terrain, const Assembly& robot, const PlantOptions& plant) {
    auto world = std::make_unique<nn::SurrogatePlant>(std::move(terrain), robot, plant, *model);
    if (bearing) world->enable_deformation(bearing);
    return world;
  };
}

std::unique_ptr<Environment> stand_in(const HeightField& terrain, const Assembly& robot,
                                      const PlantOptions& plant) {
  return std::make_unique<StandInPlant>(terrain, robot, plant);
}

}  // namespace

void choose_world(const WorldChoice& choice, SimulationOptions& options) {
  if (choice.board.has_value()) options.board = *choice.board;
  if (choice.hal == "mcu") {
    options.image = choice.elf.value_or(default_image(options.board));
  } else if (choice.elf.has_value()) {
    throw InputError("--elf needs --hal mcu");
  }
  if (choice.model.has_value() && choice.hal != "surrogate") {
    throw InputError("--model needs --hal surrogate");
  }
  if (choice.model.has_value()) {
    options.environment = networks_world(choice);
  } else if (choice.soil_model.has_value() || choice.no_ruts) {
    throw InputError("--soil-model and --no-ruts need --hal surrogate with --model");
  } else if (choice.hal == "surrogate") {
    options.environment = stand_in;
    options.least_cell_m = kStandInCell_m;
  }
}

}  // namespace screed
