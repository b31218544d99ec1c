// Robots in one world, of physics or of what stands in for it, advanced together; mostly one.
//
// The world owns its clock and its seeded generators; nothing in it looks at the wall clock or at
// global random state, so the same configuration gives the same bytes on every run and any number
// of worlds live side by side.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <ostream>
#include <vector>

#include "firmware/parameters/board_constants.h"
#include "hal/sample.h"
#include "host_sim/physics/world/plant.h"
#include "host_sim/run/world/native_robot.h"
#include "host_sim/run/world/robot_controller.h"
#include "host_sim/run/world/world_options.h"

namespace screed {

class World {
 public:
  /// Makes what drives a robot; arguments as those of RobotController.
  using ControllerFactory = std::function<std::unique_ptr<RobotController>(
      const WorldOptions& options, RobotView& robot, std::ostream* telemetry_log)>;

  /// telemetry_log, of the first robot, may be null; it must outlive the world. `first` makes the
  /// controller of the first robot; without it that is a native one, as all others are. Throws
  /// InputError when the options do not fit together.
  World(HeightField terrain, const Assembly& model, const BoardConstants& board,
        const WorldOptions& options, std::ostream* telemetry_log,
        const ControllerFactory& first = nullptr);
  /// The same with the robots in another kind of environment, which nobody has stepped yet; of the
  /// options only those count that are not the plant's.
  World(std::unique_ptr<Environment> plant, const BoardConstants& board,
        const WorldOptions& options, std::ostream* telemetry_log,
        const ControllerFactory& first = nullptr);

  /// Advances plant, sensors and radio by one physics step. Throws RunError when the physics has
  /// diverged.
  void step();
  /// The same up to the end of the control tick.
  void advance();
  /// Whether a control tick ends here: native robots have read their sensors.
  bool at_end_of_tick() const;

  size_t robots() const { return robots_.size(); }
  /// What a native robot's sensors said at the end of the last tick; number 0 is the first robot.
  const SensorSample& sample(size_t robot = 0) const { return natives_[robot]->sample(); }
  /// Applies a native robot's answer until the next tick.
  void apply(const RobotOutput& output, size_t robot = 0) { natives_[robot]->apply(output); }

  /// Control ticks begun, and as a time.
  uint64_t ticks() const { return ticks_; }
  double time_s() const { return static_cast<double>(ticks_) / kTickRate_hz; }
  const Environment& plant() const { return *plant_; }
  Environment& plant() { return *plant_; }
  const HeightField& terrain() const { return plant_->terrain(); }
  const VehicleState& vehicle() const { return plant_->vehicle(); }
  const Battery& battery() const { return plant_->battery(); }
  const GroundStation& ground_station(size_t robot = 0) const {
    return robots_[robot]->devices().ground_station();
  }
  GroundStation& ground_station(size_t robot = 0) {
    return robots_[robot]->devices().ground_station();
  }
  /// Picks the first robot up and lays it on its left side where it is.
  void lay_on_side() { plant_->lay_on_side(); }

 private:
  std::unique_ptr<Environment> plant_;
  std::vector<std::unique_ptr<RobotController>> robots_;
  std::vector<NativeRobot*> natives_;  ///< the same; null where another controller drives
  std::vector<DutyRatio> duty_ratios_;
  uint64_t ticks_ = 0;
};

}  // namespace screed
