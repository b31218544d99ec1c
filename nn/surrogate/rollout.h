// How far a surrogate of the physics diverges: from a recorded moment on it drives by itself, and
// after some distance its robot is compared with the recorded one.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "firmware/robot/robot.h"
#include "host_sim/core/task_progress.h"
#include "host_sim/devices/sensors/imu_model.h"
#include "host_sim/physics/soil/soil_parameters.h"
#include "host_sim/physics/world/environment.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/session/session_layout.h"
#include "host_sim/run/session/session_reader.h"
#include "nn/surrogate/surrogate_plant.h"

namespace screed::nn {

/// A recorded session of Algorithm 5 as rollouts need it: all rows at once, the path as travelled,
/// and the state of the robot at a row.
struct RecordedDrive {
  SessionReader session;
  Experiment experiment;
  SoilParameters soil;
  Battery battery;  ///< as the run began with it
  std::vector<SimFrame> frames;
  std::vector<SensorSample> samples;
  std::uint64_t first = 0;  ///< row with Algorithm 5's first frame
  std::vector<PlanarPose> poses;
  std::vector<FrameMotion> motions;
  std::vector<double> distances;  ///< travelled since the first row, m
  std::vector<double> drawn_c;    ///< from the battery since the start

  /// Throws InputError for a session that is not on soil, has no recorded heights, or in which
  /// Algorithm 5 drove nothing.
  explicit RecordedDrive(const std::filesystem::path& folder);

  /// Behind the row at which a rollout from `row` on has travelled `distance_m`; not more frames
  /// than that.
  std::uint64_t end_of_rollout(std::uint64_t row, double distance_m,
                               std::uint64_t max_frames) const;

  /// Of the robot at the end of a row. An encoder says its angle to a count: the middle of it.
  DrivingState state(std::uint64_t row, double counts_per_turn) const;
};

/// What of a recorded robot a surrogate of its motion does not stand in for: its firmware and its
/// sensors.
class RolloutRobot {
 public:
  /// As it is switched on, before the session's first row.
  RolloutRobot(const SessionInfo& info, const Experiment& experiment);

  /// Goes on by a row of the recording: the firmware receives the sample it received then, and the
  /// sensors' noise advances as it did.
  void follow(const SensorSample& recorded);
  /// A tick on its own: the sensors measure the robot. Of the recorded sample time and radio
  /// remain.
  void tick(const RobotView& robot, const SensorSample& recorded);

  /// The sample of such a tick: of the recorded one time and radio remain.
  SensorSample measure(const RobotView& robot, const SensorSample& recorded);

  /// The last answer of the firmware: what the motors receive of the battery voltage, -1..1.
  std::array<double, 2> duty_ratio() const;
  double counts_per_turn() const { return counts_per_turn_; }

 private:
  Robot firmware_;
  RobotOutput output_{};
  ImuModel imu_;
  double counts_per_turn_;
  BoardConstants board_;
};

/// Distances after which robots are compared, m.
inline constexpr std::array<double, 3> kRolloutDistances_m = {1.0, 5.0, 10.0};
/// Of the paths: ten poses a second.
inline constexpr std::size_t kPathFrames = 10;

struct RolloutCheck {
  bool reached = false;         ///< the recording went on so far
  bool straight = false;        ///< no turn was commanded along all of the distance
  double position_error = 0.0;  ///< share of the distance
  double heading_error_rad = 0.0;
};

struct Rollout {
  std::uint64_t start = 0;  ///< row of the session
  std::array<RolloutCheck, kRolloutDistances_m.size()> checks;
  std::vector<PlanarPose> path;  ///< ten a second, places as travelled
  /// Standard deviations of the rate of turn until the last of the distances, or the end.
  double yaw_rate_deviation_rad_per_s = 0.0;
  double recorded_yaw_rate_deviation_rad_per_s = 0.0;
};

/// Standard deviation, value by value; 0 without any.
class StandardDeviation {
 public:
  void add(double value);
  double deviation() const;

 private:
  double count_ = 0.0;
  double sum_ = 0.0;
  double squares_ = 0.0;
};

/// Follows a recorded path beside another one, row by row, and records how far they are apart.
class RolloutChecker {
 public:
  /// The recording is referred to.
  RolloutChecker(const RecordedDrive& recording, std::uint64_t start);

  /// The surrogate's pose at a row; rows come one by one, from start + 1 on.
  void add_row(std::uint64_t row, const PlanarPose& pose);
  /// What has been found; nothing may be called afterwards.
  Rollout take();

 private:
  const RecordedDrive& recording_;
  Rollout rollout_;
  double heading_rad_;
  StandardDeviation yaw_rates_;
  StandardDeviation recorded_yaw_rates_;
  std::size_t next_ = 0;
  bool straight_ = true;
};

enum class RolloutDrive : std::uint8_t {
  kFirmware,  ///< the firmware drives, from the state it had; its sensors measure the surrogate's
              ///< motion
  kTracks,    ///< the tracks turn as they were recorded; no controller corrects an error
};

/// A surrogate by its name. A rollout makes a new robot of it at each start. Without `robot`: the
/// stand-in (host_sim/standin), on a ground that it changes.
struct SurrogateFactory {
  std::string name;
  std::function<Surrogate()> robot;
};

struct SessionRollouts {
  std::string source;
  std::vector<std::vector<Rollout>> by_surrogate;  ///< in their order; the same starts
  std::vector<PlanarPose> starts;                  ///< the recorded poses there
  std::vector<std::vector<PlanarPose>> real;       ///< the recorded paths behind these starts
};

struct RolloutOptions {
  RolloutDrive drive = RolloutDrive::kFirmware;
  /// Spread evenly over what Algorithm 5 drove. 0: each begins where the one before has travelled
  /// the last of the distances, so that no frame is driven twice.
  std::size_t starts = 0;
  std::uint64_t max_frames = 40000;  ///< of a rollout: 400 s, more than 10 m take
  /// Of the task "rolling out" over a session, after every rollout; may be empty.
  TaskProgress progress;
};

/// The stand-in changes its ground; below what else is rolled out it stays as it was at the start.
/// Throws InputError for a session that cannot be followed (RecordedDrive).
SessionRollouts roll_out(const std::filesystem::path& session_folder,
                         const std::vector<SurrogateFactory>& surrogates,
                         const RolloutOptions& options);

/// How far two recordings of Algorithm 5 have diverged after each of the distances, the first one's
/// as the reference: physics beside physics that began a little elsewhere. Both begin where their
/// drive does.
Rollout divergence(const std::filesystem::path& session_folder, const std::filesystem::path& other);

}  // namespace screed::nn
