// Robots in one world, of physics or of what stands in for it, advanced together.
//
// The world owns its clock and its seeded generators; nothing in it looks at the wall clock or at
// global random state, so the same configuration gives the same bytes on every run and any number
// of worlds live side by side.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "hal/sample.h"
#include "host_sim/devices/mcu/cycle_report.h"
#include "host_sim/physics/world/environment.h"
#include "host_sim/run/world/robot_controller.h"
#include "host_sim/run/world/robot_watch.h"
#include "host_sim/run/world/world_options.h"

namespace screed {

class World {
 public:
  /// The robots of this plant, which nobody has stepped yet; of the options those count that are
  /// not the plant's. Throws InputError for an image that cannot be run, and for options of another
  /// number of robots.
  World(std::unique_ptr<Environment> plant, const WorldOptions& options);

  /// Advances all until each robot has answered. Native ones do at the end of each control tick of
  /// the world, an image a moment later and, while it starts, less often. The watch, which may be
  /// null, sees it; returns false when it wanted no answer. Throws RunError when the physics
  /// diverges or an image crashes, hangs or misuses a chip.
  bool advance(RobotWatch* watch = nullptr);

  size_t robots() const { return robots_.size(); }
  RobotController& robot(size_t number = 0) { return *robots_[number]; }
  const RobotController& robot(size_t number = 0) const { return *robots_[number]; }
  /// What a robot has read and answered, newest.
  const SensorSample& sample(size_t robot = 0) const { return robots_[robot]->sample(); }
  const RobotOutput& output(size_t robot = 0) const { return robots_[robot]->output(); }
  /// The firmware of a native robot.
  const Robot& firmware(size_t robot = 0) const { return *robots_[robot]->firmware(); }
  const GroundStation& ground_station(size_t robot = 0) const {
    return robots_[robot]->devices().ground_station();
  }
  GroundStation& ground_station(size_t robot = 0) {
    return robots_[robot]->devices().ground_station();
  }

  /// Control ticks begun, and as a time.
  uint64_t ticks() const { return ticks_; }
  double time_s() const { return static_cast<double>(ticks_) / kTickRate_hz; }
  const Environment& plant() const { return *plant_; }
  Environment& plant() { return *plant_; }
  const HeightField& terrain() const { return plant_->terrain(); }
  const VehicleState& vehicle(size_t robot = 0) const { return plant_->robot(robot).vehicle(); }
  const Battery& battery(size_t robot = 0) const { return plant_->robot(robot).battery(); }

 private:
  /// Plant, sensors and radio, by one physics step.
  void step();

  std::unique_ptr<Environment> plant_;
  std::vector<std::unique_ptr<RobotController>> robots_;
  std::vector<DutyRatio> duty_ratios_;
  uint64_t ticks_ = 0;
};

}  // namespace screed
