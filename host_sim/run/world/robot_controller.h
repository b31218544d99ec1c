// What drives one robot of a world and all that surrounds it: its microcontroller or what stands
// for it, its sensors and its radio. The world steps the plant of all robots, and tells each
// controller when.
//
// There are two kinds: the firmware compiled for this machine looks at the world once a control
// tick (native_robot.h), the flash image lives through every microsecond of it (mcu_robot.h).
#pragma once

#include <cstdint>
#include <ostream>

#include "hal/sample.h"
#include "host_sim/physics/world/environment.h"
#include "host_sim/run/world/robot_devices.h"
#include "host_sim/run/world/world_options.h"

namespace screed {

class RobotController {
 public:
  /// Of this robot of a plant; both it and the log, which may be null, must outlive the controller.
  RobotController(const WorldOptions& options, RobotView& robot, std::ostream* telemetry_log)
      : robot_(robot), devices_(options, robot, telemetry_log) {}
  RobotController(const RobotController&) = delete;
  RobotController& operator=(const RobotController&) = delete;
  virtual ~RobotController() = default;

  /// The world begins a control tick, counted from 1. Before its physics.
  virtual void begin_tick(uint64_t tick) = 0;
  /// What the motors get in the next physics step.
  virtual DutyRatio duty_ratio() const = 0;
  /// The plant has taken a physics step, of all robots.
  virtual void end_step() = 0;

  RobotDevices& devices() { return devices_; }
  const RobotDevices& devices() const { return devices_; }

 protected:
  RobotView& robot() { return robot_; }
  const RobotView& robot() const { return robot_; }
  /// The world's clock after so many steps, and now.
  uint64_t us_at(uint64_t steps) const {
    return steps * kTickPeriod_us / static_cast<uint64_t>(robot_.steps_per_tick());
  }
  uint64_t world_us() const { return us_at(robot_.steps()); }

 private:
  RobotView& robot_;
  RobotDevices devices_;
};

}  // namespace screed
