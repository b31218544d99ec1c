// One robot in one world, of physics or of what stands in for it, advanced a control tick at a
// time.
//
// The world owns its clock and its seeded generators; nothing in it looks at the wall clock or at
// global random state, so the same configuration gives the same bytes on every run and any number
// of worlds live side by side.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <ostream>

#include "firmware/parameters/board_constants.h"
#include "hal/sample.h"
#include "host_sim/physics/world/plant.h"
#include "host_sim/run/world/robot_devices.h"
#include "host_sim/run/world/world_options.h"

namespace screed {

class World {
 public:
  /// telemetry_log may be null; it must outlive the world. Throws InputError when the options do
  /// not fit together.
  World(HeightField terrain, const Assembly& model, const BoardConstants& board,
        const WorldOptions& options, std::ostream* telemetry_log);
  /// The same with the robot in another kind of environment; of the options only those count that
  /// are not the plant's.
  World(std::unique_ptr<Environment> plant, const BoardConstants& board,
        const WorldOptions& options, std::ostream* telemetry_log);

  /// Advances physics, sensors and radio by one control tick. Throws RunError when the physics has
  /// diverged.
  void advance();
  /// What the robot's sensors say now.
  const SensorSample& sample() const { return sample_; }
  /// Applies the robot's answer until the next tick.
  void apply(const RobotOutput& output);

  uint64_t ticks() const { return ticks_; }
  double time_s() const { return static_cast<double>(ticks_) / kTickRate_hz; }
  const Environment& plant() const { return *plant_; }
  const HeightField& terrain() const { return plant_->terrain(); }
  const VehicleState& vehicle() const { return plant_->vehicle(); }
  const Battery& battery() const { return plant_->battery(); }
  const GroundStation& ground_station() const { return devices_.ground_station(); }
  GroundStation& ground_station() { return devices_.ground_station(); }
  /// Picks the robot up and lays it on its left side where it is.
  void lay_on_side() { plant_->lay_on_side(); }

 private:
  void step_physics();
  void measure();
  void receive_radio();
  uint64_t now_us() const { return ticks_ * kTickPeriod_us; }

  bool calibration_motion_;
  BoardConstants board_;
  std::unique_ptr<Environment> plant_;
  RobotDevices devices_;
  uint64_t ticks_ = 0;
  std::array<int16_t, 2> duty_ = {0, 0};
  SensorSample sample_{};
};

}  // namespace screed
