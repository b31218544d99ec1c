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
#include <optional>
#include <ostream>

#include "firmware/parameters/board_constants.h"
#include "hal/sample.h"
#include "host_sim/devices/radio/radio_link.h"
#include "host_sim/devices/sensors/imu_model.h"
#include "host_sim/ground_station/station/ground_end.h"
#include "host_sim/ground_station/station/ground_station.h"
#include "host_sim/physics/world/plant.h"

namespace screed {

struct WorldOptions : PlantOptions {
  uint64_t seed = 1;
  ImuErrors imu;
  RadioOptions radio;
  bool ground_station_arms = true;
  std::optional<DriveCommand> drive;
  CommandKey ground_key = test_key();  ///< what the ground station signs with
  /// Programs outside at the ground end of the radio; may be null, must outlive the world.
  GroundPort* ground_port = nullptr;
  /// The IMU feels a person turning the robot over (calibration_motion.h) instead of its own
  /// motion.
  bool handled = false;
  double encoder_counts_per_turn = 1000.0 / 3.0;
  /// The robot is laid on its left side at this time, s: a fault to inject.
  std::optional<double> lay_on_side_at_s;
};

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
  const GroundStation& ground_station() const { return ground_; }
  GroundStation& ground_station() { return ground_; }
  /// Picks the robot up and lays it on its left side where it is.
  void lay_on_side() { plant_->lay_on_side(); }

 private:
  void step_physics();
  void measure();
  void exchange_radio();
  uint64_t now_us() const { return ticks_ * kTickPeriod_us; }

  WorldOptions options_;
  BoardConstants board_;
  std::unique_ptr<Environment> plant_;
  ImuModel imu_;
  RadioLink uplink_;
  RadioLink downlink_;
  GroundStation ground_;
  GroundEnd ground_end_;
  Eigen::Vector3d station_m_;  ///< the ground station stands where the robot starts
  uint64_t ticks_ = 0;
  std::array<int16_t, 2> duty_ = {0, 0};
  SensorSample sample_{};
};

}  // namespace screed
