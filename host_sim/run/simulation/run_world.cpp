// Which of the two worlds a run needs.
#include "host_sim/run/simulation/run_world.h"

#include "host_sim/core/errors.h"
#include "host_sim/run/world/world_setup.h"

namespace screed {

RunWorld::RunWorld(const Experiment& experiment, const SimulationOptions& options,
                   std::span<std::ostream* const> telemetry_logs)
    : robot_settings_(screed::robot_settings(experiment, options.board)) {
  WorldSetup setup;
  setup.board = options.board;
  setup.ground_port = options.ground_port;
  setup.environment = options.environment;
  setup.progress = options.setup_progress;
  std::ostream* const telemetry_log = telemetry_logs.empty() ? nullptr : telemetry_logs[0];
  if (!telemetry_logs.empty())
    setup.further_telemetry_logs.assign(telemetry_logs.begin() + 1, telemetry_logs.end());
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

std::optional<CycleReport> RunWorld::cycles() const {
  return image_ ? std::optional(image_->cycles()) : std::nullopt;
}

}  // namespace screed
