// The firmware of the robots behind the first one of a world. The first one's main loop, or its
// flash image, sets the pace of a run; the others are cores that answer once a control tick of the
// world.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "firmware/robot/robot.h"
#include "hal/sample.h"
#include "host_sim/run/world/robot_settings.h"
#include "host_sim/run/world/world.h"

namespace screed {

/// Sees what a robot reads and what it answers, of which the world has not been told yet. Either
/// may be empty.
struct RobotWatch {
  std::function<void(size_t robot, const SensorSample& sample)> sample;
  std::function<void(size_t robot, const RobotOutput& output)> output;
};

class FurtherRobots {
 public:
  /// Settings are of all robots of the world, the first one included. The world must outlive this.
  FurtherRobots(World& world, std::span<const RobotSettings> settings, RobotWatch watch = {});

  /// When a control tick of the world has ended: each in turn does what the main loop does.
  void answer();

 private:
  World& world_;
  RobotWatch watch_;
  std::vector<Robot> robots_;
  std::vector<RobotOutput> outputs_;  ///< one for all ticks, as in the main loop
};

}  // namespace screed
