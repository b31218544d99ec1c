// From the user's words to options of a simulation.
#include "tools/screed/cli/world_choice.h"

#include <filesystem>
#include <memory>

#include "host_sim/core/errors.h"
#include "nn/model/model_file.h"
#include "nn/surrogate/default_model.h"
#include "nn/surrogate/surrogate_plant.h"

namespace screed {
namespace {

EnvironmentFactory surrogate(const WorldChoice& choice) {
  const auto model = std::make_shared<const nn::Model>(nn::read_model(
      choice.model.has_value() ? std::filesystem::path(*choice.model) : nn::default_model_file()));
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

}  // namespace

void choose_world(const WorldChoice& choice, SimulationOptions& options) {
  if (choice.board.has_value()) options.board = *choice.board;
  if (choice.hal == "mcu") {
    options.image = choice.elf.value_or(default_image(options.board));
  } else if (choice.elf.has_value()) {
    throw InputError("--elf needs --hal mcu");
  }
  if (choice.hal == "surrogate") {
    options.environment = surrogate(choice);
  } else if (choice.model.has_value() || choice.soil_model.has_value() || choice.no_ruts) {
    throw InputError("--model, --soil-model and --no-ruts need --hal surrogate");
  }
}

}  // namespace screed
