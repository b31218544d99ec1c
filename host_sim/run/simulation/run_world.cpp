// Which of the two worlds a run needs.
#include "host_sim/run/simulation/run_world.h"

#include "host_sim/core/errors.h"
#include "host_sim/run/world/world_setup.h"

namespace screed {

RunWorld::RunWorld(const Experiment& experiment, const SimulationOptions& options,
                   std::ostream* telemetry_log)
    : robot_settings_{board_constants_of(options.board), experiment.parameters,
                      credentials_of(experiment)} {
  const WorldSetup setup{options.board, options.ground_port, options.environment,
                         options.setup_progress};
  if (!options.image.has_value()) {
    native_ = make_world(experiment, telemetry_log, setup);
    return;
  }
  if (experiment.experiment.algorithm == kTrainingDriveName) {
    throw InputError(
        "[experiment] algorithm = training_drive is not part of the microcontroller's image; it "
        "runs without --hal mcu");
  }
  image_ = make_co_simulation(experiment, telemetry_log, *options.image, setup);
}

const GroundStation& RunWorld::ground_station() const {
  return image_ ? image_->ground_station() : std::as_const(*native_).ground_station();
}

std::optional<CycleReport> RunWorld::cycles() const {
  return image_ ? std::optional(image_->cycles()) : std::nullopt;
}

}  // namespace screed
