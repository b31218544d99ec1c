// Recordings of drives that are known in closed form, for tests of what follows recordings.
#pragma once

#include <cmath>
#include <functional>

#include "firmware/leveling/leveling.h"
#include "host_sim/physics/terrain/height_field.h"
#include "nn/surrogate/surrogate.h"
#include "tests/unit/host_sim/run/session/session_fixture.h"

namespace screed::nn {

/// A drive from a place, with every frame the same displacement and change of heading, of tracks
/// that do not slip.
struct MadeUpDrive {
  double x = 0.0;
  double y = 0.0;
  double heading_rad = 0.0;
  double distance_m = 0.005;  ///< a frame
  double turn_rad = 0.0;      ///< a frame
  double angular = 0.0;       ///< rate of turn that was wanted
  std::size_t frames = 1200;
  std::size_t before = 5;  ///< frames at rest before Algorithm 5 begins
  std::string experiment =
      "[map]\nmodel = scm\n[soil]\npreset = viper\n[experiment]\nname = made_up\n";
  HeightField ground = HeightField(16, 16, 0.25, true);
  bool heights = true;  ///< of the ground are recorded
  /// Changes of the ground, and the row with which they come.
  std::vector<HeightChange> changes;
  std::size_t changed_at = 0;
  /// The row is recorded as this leaves it.
  std::function<void(std::size_t row, SimFrame&, SensorSample&)> alter;
};

/// Bits of a metre: sums of any number of such distances are exact.
inline constexpr double kExact_m = 1.0 / 128.0;
inline constexpr double kTread_m = 0.127;

/// Of tracks that turn the robot less than half as much as tracks that do not slip.
inline TrackKinematics skid_of(double speed_share) {
  return skid_kinematics(speed_share, 0.275);
}

inline HeightMap map_of(const HeightField& field) {
  HeightMap map;
  map.geometry = {static_cast<std::uint32_t>(field.nx()),
                  static_cast<std::uint32_t>(field.ny()),
                  kHeightUnit_m,
                  field.spacing_m(),
                  field.x_min(),
                  field.y_min(),
                  field.wrap()};
  const auto nodes = static_cast<std::size_t>(field.nx()) * static_cast<std::size_t>(field.ny());
  for (std::size_t node = 0; node < nodes; ++node) map.heights.push_back(field.node(node));
  return map;
}

inline SessionInfo info_of_drive() {
  SessionInfo info = random_run(0).info;
  info.parameters = {};
  info.experiment_name = "made_up";
  return info;
}

/// The folder must not exist.
inline void record(const fs::path& folder, const MadeUpDrive& drive) {
  fs::create_directories(folder);
  write_text(folder / "experiment.ini", drive.experiment);
  SessionWriter writer(folder / "session.h5", info_of_drive());
  if (drive.heights) writer.record_heights(map_of(drive.ground).view());
  double x = drive.x;
  double y = drive.y;
  double heading = drive.heading_rad;
  for (std::size_t i = 0; i < drive.before + drive.frames; ++i) {
    SimFrame frame{};
    SensorSample sample{};
    frame.x = x;
    frame.y = y;
    frame.yaw = heading;
    if (i >= drive.before) {
      const double middle = heading + 0.5 * drive.turn_rad;
      frame.delta_x = drive.distance_m * std::cos(middle);
      frame.delta_y = drive.distance_m * std::sin(middle);
      frame.delta_theta = drive.turn_rad;
      const double apart = 0.5 * kTread_m * drive.turn_rad;
      frame.track_left = (drive.distance_m - apart) * 100.0;
      frame.track_right = (drive.distance_m + apart) * 100.0;
      frame.angular = drive.angular;
      frame.leveling_state = static_cast<std::int32_t>(LevelingState::kTrainingDrive);
    }
    if (drive.alter) drive.alter(i, frame, sample);
    writer.append(frame, sample, RobotOutput{},
                  i == drive.changed_at ? std::span<const HeightChange>(drive.changes)
                                        : std::span<const HeightChange>());
    x += frame.delta_x;
    y += frame.delta_y;
    heading += frame.delta_theta;
  }
  writer.finish();
}

}  // namespace screed::nn
