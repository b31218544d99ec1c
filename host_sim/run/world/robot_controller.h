// A robot of a world: its brain, and all that surrounds it but the bodies, which the world steps
// for all robots together.
//
// There are two kinds of brain. The firmware compiled for this machine looks at the world once a
// control tick (native_robot.h); the flash image lives through every microsecond of it
// (mcu_robot.h).
#pragma once

#include <cstdint>
#include <optional>

#include "firmware/robot/robot.h"
#include "hal/sample.h"
#include "host_sim/devices/mcu/cycle_report.h"
#include "host_sim/physics/world/environment.h"
#include "host_sim/run/world/robot_devices.h"
#include "host_sim/run/world/robot_watch.h"
#include "host_sim/run/world/world_options.h"

namespace screed {

class RobotController {
 public:
  /// How far a brain came.
  enum class Progress : uint8_t {
    kNoAnswer,  ///< in this step
    kAnswered,  ///< a sample
    kOver,      ///< the watch did not want an answer
  };

  /// Of robot `number` of a plant, which must outlive the controller.
  RobotController(const WorldOptions& options, Environment& plant, size_t number)
      : number_(number),
        plant_(plant),
        robot_(plant.robot(number)),
        settings_(options.robots[number].settings),
        devices_(options, number, robot_) {}
  RobotController(const RobotController&) = delete;
  RobotController& operator=(const RobotController&) = delete;
  virtual ~RobotController() = default;

  /// The world begins a control tick, counted from 1. Before its physics.
  virtual void begin_tick(uint64_t tick) = 0;
  /// What the motors get in the next physics step.
  virtual DutyRatio duty_ratio() const = 0;
  /// The plant has taken a physics step, of all robots: what happened to this one's devices.
  virtual void end_step() = 0;
  /// The brain lives through that step. The watch may be null.
  virtual Progress live(RobotWatch* watch) = 0;

  /// What its firmware started with.
  const RobotSettings& settings() const { return settings_; }
  /// The newest that it has read and answered.
  virtual const SensorSample& sample() const = 0;
  virtual const RobotOutput& output() const = 0;
  /// Its firmware; null where that is an image.
  virtual const Robot* firmware() const { return nullptr; }
  /// What a microcontroller's time went into; nothing where there is none.
  virtual std::optional<CycleReport> cycles() const { return std::nullopt; }

  RobotDevices& devices() { return devices_; }
  const RobotDevices& devices() const { return devices_; }

 protected:
  size_t number() const { return number_; }
  const Environment& plant() const { return plant_; }
  RobotView& robot() { return robot_; }
  const RobotView& robot() const { return robot_; }
  /// The world's clock after so many steps, and now.
  uint64_t us_at(uint64_t steps) const {
    return steps * kTickPeriod_us / static_cast<uint64_t>(plant_.steps_per_tick());
  }
  uint64_t world_us() const { return us_at(plant_.steps()); }

 private:
  size_t number_;
  const Environment& plant_;
  RobotView& robot_;
  RobotSettings settings_;
  RobotDevices devices_;
};

}  // namespace screed
