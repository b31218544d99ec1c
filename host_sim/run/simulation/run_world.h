// The world of a run with the firmware in it: compiled for this machine, or in the first robot as
// the image that is flashed, under the microcontroller simulation.
#pragma once

#include <memory>
#include <optional>
#include <ostream>
#include <span>
#include <utility>
#include <vector>

#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/simulation/simulation_options.h"
#include "host_sim/run/world/co_simulation.h"
#include "host_sim/run/world/robot_settings.h"
#include "host_sim/run/world/world.h"

namespace screed {

class RunWorld {
 public:
  /// One telemetry log a robot, or none; they must outlive this. Throws InputError when the
  /// experiment and the options cannot be run, and then no file has been made.
  RunWorld(const Experiment& experiment, const SimulationOptions& options,
           std::span<std::ostream* const> telemetry_logs);
  /// With an image that is there already.
  RunWorld(const RobotSettings& robot_settings, std::unique_ptr<CoSimulation> image)
      : robot_settings_{robot_settings}, image_(std::move(image)) {}

  /// What drives the first robot; null when it is a native one.
  CoSimulation* image() { return image_.get(); }
  World& world() { return image_ ? image_->world() : *native_; }
  const World& world() const { return image_ ? image_->world() : *native_; }

  const Environment& plant() const { return world().plant(); }
  /// Numbered from 0.
  size_t robots() const { return robot_settings_.size(); }
  const RobotView& robot(size_t number) const { return plant().robot(number); }
  const GroundStation& ground_station(size_t robot = 0) const {
    return world().ground_station(robot);
  }
  const RobotSettings& robot_settings(size_t robot = 0) const { return robot_settings_[robot]; }
  std::span<const RobotSettings> all_robot_settings() const { return robot_settings_; }
  /// What the microcontroller's time went into; nothing when there is none.
  std::optional<CycleReport> cycles() const;

 private:
  std::vector<RobotSettings> robot_settings_;  ///< of each robot
  // Exactly one of the two is there.
  std::unique_ptr<World> native_;
  std::unique_ptr<CoSimulation> image_;
};

}  // namespace screed
