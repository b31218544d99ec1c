// The world of a run with the firmware in it: compiled for this machine, or as the image that is
// flashed, under the microcontroller simulation.
#pragma once

#include <memory>
#include <optional>
#include <ostream>
#include <utility>

#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/simulation/simulation_options.h"
#include "host_sim/run/world/co_simulation.h"
#include "host_sim/run/world/world.h"

namespace screed {

/// What a robot's firmware is given at its start.
struct RobotSettings {
  BoardConstants board;
  Parameters parameters;
  Credentials credentials;
};

class RunWorld {
 public:
  /// telemetry_log may be null; it must outlive this. Throws InputError when the experiment and the
  /// options cannot be run, and then no file has been made.
  RunWorld(const Experiment& experiment, const SimulationOptions& options,
           std::ostream* telemetry_log);
  /// With an image that is there already.
  RunWorld(const RobotSettings& robot_settings, std::unique_ptr<CoSimulation> image)
      : robot_settings_(robot_settings), image_(std::move(image)) {}

  /// Exactly one of the two is there.
  World* native() { return native_.get(); }
  CoSimulation* image() { return image_.get(); }

  const Environment& plant() const { return image_ ? image_->plant() : native_->plant(); }
  const GroundStation& ground_station() const;
  const RobotSettings& robot_settings() const { return robot_settings_; }
  /// What the microcontroller's time went into; nothing when there is none.
  std::optional<CycleReport> cycles() const;

 private:
  RobotSettings robot_settings_;
  std::unique_ptr<World> native_;
  std::unique_ptr<CoSimulation> image_;
};

}  // namespace screed
