// A world with the firmware in it, tick by tick and without any recording: what benchmarks of a
// tick time.
#pragma once

#include <cstdint>
#include <memory>

#include "firmware/robot/robot.h"
#include "host_sim/core/errors.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/simulation/simulation.h"
#include "tools/screed/cli/world_choice.h"

namespace screed {

/// A world with its robot, which is running.
class TimedDrive {
 public:
  explicit TimedDrive(const Experiment& experiment, const WorldChoice& choice = {})
      : experiment_(experiment),
        world_(make_world(experiment_, {.environment = environment_of(choice)})) {
    constexpr uint64_t kLongestStart = 20U * uint64_t{kTickRate_hz};
    while (!is_running(robot())) {
      if (world_->ticks() > kLongestStart) throw RunError("the robot does not begin to drive");
      tick();
    }
  }

  static bool is_running(const Robot& robot) {
    return robot.supervisor().state() == RobotState::kRunning;
  }

  void tick() { world_->advance(); }

  static EnvironmentFactory environment_of(const WorldChoice& choice) {
    SimulationOptions options;
    choose_world(choice, options);
    return options.environment;
  }

  bool is_over() const {
    return static_cast<double>(world_->ticks()) >= experiment_.experiment.duration_s * kTickRate_hz;
  }
  const Robot& robot() const { return world_->firmware(); }
  Eigen::Vector3d place() const { return world_->plant().robot(0).unwrapped_position(); }
  /// Of the last tick.
  const SensorSample& sample() const { return world_->sample(); }

 private:
  Experiment experiment_;
  std::unique_ptr<World> world_;
};

}  // namespace screed
