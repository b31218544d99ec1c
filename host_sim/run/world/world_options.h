// What a world is made of beside its terrain and the robots' bodies: physics, sensors, radio,
// ground station, scripted events.
#pragma once

#include <cstdint>
#include <optional>
#include <ostream>
#include <vector>

#include "host_sim/devices/radio/radio_link.h"
#include "host_sim/devices/sensors/imu_model.h"
#include "host_sim/ground_station/station/command_key.h"
#include "host_sim/ground_station/station/ground_port.h"
#include "host_sim/ground_station/station/ground_station.h"
#include "host_sim/ground_station/station/position_fixes.h"
#include "host_sim/physics/world/plant_options.h"

namespace screed {

struct WorldOptions : PlantOptions {
  uint64_t seed = 1;
  ImuErrors imu;
  RadioOptions radio;
  bool ground_station_arms = true;
  std::optional<DriveCommand> drive;
  /// Of the robots behind the first one's; where there is none for a robot it has `drive`.
  std::vector<std::optional<DriveCommand>> further_drives;
  PositionFixOptions fixes;
  CommandKey ground_key = test_key();  ///< what the ground station signs with
  /// Programs outside at the ground end of the radio; may be null, must outlive the world.
  GroundPort* ground_port = nullptr;
  /// The IMU feels a person turning the robot over (calibration_motion.h) instead of its own
  /// motion.
  bool calibration_motion = false;
  double encoder_counts_per_turn = 1000.0 / 3.0;
  /// The robot is laid on its left side at this time, s: a fault to inject. Of several the first.
  std::optional<double> lay_on_side_at_s;
  /// Telemetry of the robots behind the first; null, or none: nobody keeps it. Must outlive the
  /// world.
  std::vector<std::ostream*> further_telemetry_logs;
};

}  // namespace screed
