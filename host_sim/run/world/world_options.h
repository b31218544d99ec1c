// What a world is made of beside its terrain and the robots' bodies: sensors, radio, ground
// station, scripted events, and what each robot is driven by.
#pragma once

#include <cstdint>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "firmware/parameters/board_constants.h"
#include "firmware/parameters/parameters.h"
#include "firmware/security/credentials.h"
#include "host_sim/devices/radio/radio_link.h"
#include "host_sim/devices/sensors/imu_model.h"
#include "host_sim/ground_station/station/command_key.h"
#include "host_sim/ground_station/station/ground_port.h"
#include "host_sim/ground_station/station/ground_station.h"
#include "host_sim/ground_station/station/position_fixes.h"
#include "host_sim/physics/world/plant_options.h"

namespace screed {

/// What firmware starts with.
struct RobotSettings {
  BoardConstants board{};
  Parameters parameters;
  Credentials credentials = credentials_of(test_key());
};

/// A flash image, and the board that it runs on.
struct RobotImage {
  std::string elf;
  std::string board;  ///< a folder in boards/
};

/// What is one robot's own.
struct RobotOptions {
  RobotSettings settings;
  /// Drives it, with parameters and credentials in its EEPROM; without one it is firmware compiled
  /// for this machine.
  std::optional<RobotImage> image;
  std::optional<DriveCommand> drive;   ///< the ground station commands it
  CommandKey ground_key = test_key();  ///< what the ground station signs with
  /// Programs outside at the ground end of the radio; may be null, must outlive the world.
  GroundPort* ground_port = nullptr;
  /// May be null, must outlive the world.
  std::ostream* telemetry_log = nullptr;
  /// The robot is laid on its left side at this time, s: a fault to inject.
  std::optional<double> lay_on_side_at_s;
};

struct WorldOptions : PlantOptions {
  std::vector<RobotOptions> robots{1};  ///< as many as there are starts
  uint64_t seed = 1;                    ///< each robot's is made of it (robot_number.h)
  ImuErrors imu;
  RadioOptions radio;
  bool ground_station_arms = true;
  PositionFixOptions fixes;
  /// The IMU feels a person turning the robot over (calibration_motion.h) instead of its own
  /// motion.
  bool calibration_motion = false;
  double encoder_counts_per_turn = 1000.0 / 3.0;
};

}  // namespace screed
