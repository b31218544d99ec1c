#include "nn/surrogate/rollout.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "firmware/leveling/leveling.h"
#include "firmware/robot/robot.h"
#include "host_sim/core/errors.h"
#include "host_sim/physics/vehicle/urdf/urdf_importer.h"
#include "host_sim/run/experiment/board_table.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/session/height_export.h"
#include "host_sim/run/session/session_reader.h"
#include "host_sim/run/simulation/simulation.h"
#include "nn/terrain/sinkage_replay.h"

namespace screed::nn {
namespace {

constexpr std::size_t kPathFrames = 10;
constexpr double kMeanVoltage = 7.5;  // from energy to charge
constexpr double kFrame_s = 0.01;

/// Standard deviation, value by value.
class StandardDeviation {
 public:
  void add(double value) {
    count_ += 1.0;
    sum_ += value;
    squares_ += value * value;
  }
  double deviation() const {
    if (count_ == 0.0) return 0.0;
    const double mean = sum_ / count_;
    return std::sqrt(std::max(0.0, squares_ / count_ - mean * mean));
  }

 private:
  double count_ = 0.0;
  double sum_ = 0.0;
  double squares_ = 0.0;
};

/// A session as a rollout needs it, all rows at once.
struct Recording {
  SessionReader session;
  Experiment experiment;
  SoilParameters soil;
  std::vector<SimFrame> frames;
  std::vector<SensorSample> samples;
  std::uint64_t first = 0;  ///< row with Algorithm 5's first frame
  std::vector<PlanarPose> poses;
  std::vector<FrameMotion> motions;
  std::vector<double> distances;  ///< travelled since the first row, m

  explicit Recording(const std::filesystem::path& folder)
      : session(folder / "session.h5"), experiment(read_experiment(folder / "experiment.ini")) {
    if (experiment.map.model != "scm" || !session.has_heights()) {
      throw InputError(folder.string() +
                       ": rollouts need a session on soil (scm) with its heights, as screed "
                       "record makes it");
    }
    soil = make_soil(experiment);
    frames.resize(session.frames());
    samples.resize(session.frames());
    session.read(0, std::span(frames));
    session.read(0, std::span(samples));
    PlanarPose pose{frames[0].x, frames[0].y, frames[0].yaw};
    for (const SimFrame& frame : frames) {
      const double middle = pose.heading_rad + 0.5 * frame.delta_theta;
      const double c = std::cos(middle);
      const double s = std::sin(middle);
      motions.push_back({frame.delta_x * c + frame.delta_y * s,
                         frame.delta_y * c - frame.delta_x * s, frame.delta_theta});
      pose.move(motions.back());
      poses.push_back(pose);
      distances.push_back((distances.empty() ? 0.0 : distances.back()) +
                          std::hypot(frame.delta_x, frame.delta_y));
    }
    while (first < frames.size() && frames[first].leveling_state !=
                                        static_cast<std::int32_t>(LevelingState::kTrainingDrive)) {
      ++first;
    }
    if (first + 3 >= frames.size()) {
      throw InputError(folder.string() + ": Algorithm 5 drove no frame of it");
    }
  }

  /// Behind the row at which a rollout from `row` on has travelled all distances; not more frames
  /// than that.
  std::uint64_t end_of_rollout(std::uint64_t row, std::uint64_t max_frames) const {
    const std::uint64_t last = std::min<std::uint64_t>(frames.size(), row + 1 + max_frames);
    std::uint64_t end = row + 1;
    while (end < last && distances[end - 1] - distances[row] < kRolloutDistances_m.back()) ++end;
    return end;
  }

  DrivingState state(std::uint64_t row, double counts_per_turn) const {
    const SimFrame& frame = frames[row];
    DrivingState state;
    state.pose = poses[row];
    state.last = motions[row];
    state.before_last = motions[row - 1];
    state.track_speed_m_per_s = {frame.track_left, frame.track_right};
    const auto angle = [&](std::uint16_t count) {
      return (count + 0.5) / counts_per_turn * 2.0 * std::numbers::pi;
    };
    state.shaft_angle_rad = {angle(samples[row].encoder_left), angle(samples[row].encoder_right)};
    state.battery.terminal_v = frame.battery;
    state.battery.drawn_c = frame.energy / kMeanVoltage;
    state.battery.energy_j = frame.energy;
    return state;
  }
};

/// Follows the recorded path and records errors along it.
class Checker {
 public:
  Checker(const Recording& recording, std::uint64_t start)
      : recording_(recording), heading_rad_(recording.poses[start].heading_rad) {
    rollout_.start = start;
  }
  /// The surrogate's pose at a row. False: all distances are travelled.
  bool add_row(std::uint64_t row, const PlanarPose& pose) {
    if ((row - rollout_.start) % kPathFrames == 0) rollout_.path.push_back(pose);
    if (recording_.frames[row].angular != 0.0) straight_ = false;
    yaw_rates_.add((pose.heading_rad - heading_rad_) / kFrame_s);
    recorded_yaw_rates_.add(recording_.motions[row].turn_rad / kFrame_s);
    heading_rad_ = pose.heading_rad;
    const double distance = recording_.distances[row] - recording_.distances[rollout_.start];
    while (next_ < kRolloutDistances_m.size() && distance >= kRolloutDistances_m.at(next_)) {
      const PlanarPose& real = recording_.poses[row];
      rollout_.checks.at(next_) = {
          true, straight_,
          std::hypot(pose.x_m - real.x_m, pose.y_m - real.y_m) / kRolloutDistances_m.at(next_),
          std::abs(pose.heading_rad - real.heading_rad)};
      ++next_;
    }
    return next_ < kRolloutDistances_m.size();
  }
  Rollout take() {
    rollout_.yaw_rate_deviation_rad_per_s = yaw_rates_.deviation();
    rollout_.recorded_yaw_rate_deviation_rad_per_s = recorded_yaw_rates_.deviation();
    return std::move(rollout_);
  }

 private:
  const Recording& recording_;
  Rollout rollout_;
  double heading_rad_;
  StandardDeviation yaw_rates_;
  StandardDeviation recorded_yaw_rates_;
  std::size_t next_ = 0;
  bool straight_ = true;
};

Rollout by_tracks(const Recording& recording, std::uint64_t start, std::uint64_t end,
                  const HeightField& ground, Surrogate robot) {
  const SimFrame& now = recording.frames[start];
  robot.set_soil(0, recording.soil);
  robot.set_pose(0, recording.poses[start], recording.motions[start], recording.motions[start - 1]);
  robot.set_tracks(0, now.track_left, now.track_right);
  Checker checker(recording, start);
  for (std::uint64_t row = start + 1; row < end; ++row) {
    const SimFrame& frame = recording.frames[row];
    robot.step(ground, {&frame.track_left, 1}, {&frame.track_right, 1});
    if (!checker.add_row(row, robot.pose(0))) break;
  }
  return checker.take();
}

Rollout by_firmware(const Recording& recording, std::uint64_t start, std::uint64_t end,
                    SurrogatePlant& plant, Robot firmware, RobotOutput output, ImuModel imu,
                    double counts_per_turn) {
  plant.set_state(recording.state(start, counts_per_turn));
  const auto counts = [&](Side side) {
    const double turns = plant.vehicle().shaft_angle_rad(side) / (2.0 * std::numbers::pi);
    return static_cast<std::uint16_t>(
        static_cast<std::int64_t>(std::floor(turns * counts_per_turn)) & 0xFFFF);
  };
  const double volt_per_lsb = recording.session.info().board.battery_uv_per_lsb * 1e-6;
  Checker checker(recording, start);
  for (std::uint64_t row = start + 1; row < end; ++row) {
    const std::array<double, 2> duty_ratio = {static_cast<double>(output.duty_left) / kDutyMax,
                                              static_cast<double>(output.duty_right) / kDutyMax};
    for (int i = 0; i < plant.steps_per_tick(); ++i) plant.step(duty_ratio);
    if (!checker.add_row(row, plant.pose())) break;
    // Time and radio as they were.
    SensorSample sample = recording.samples[row];
    imu.measure(plant.motion(), sample);
    sample.encoder_left = counts(kLeft);
    sample.encoder_right = counts(kRight);
    sample.battery = static_cast<std::uint16_t>(std::clamp(
        std::round(plant.battery().terminal_v / volt_per_lsb), 0.0, double{kBatteryMax}));
    firmware.tick(sample, output);
  }
  return checker.take();
}

ImuErrors imu_errors(const Experiment& experiment) {
  if (!experiment.sensors.noise) return ImuErrors::quiet();
  return experiment.sensors.calibrated ? ImuErrors{} : ImuErrors::uncalibrated();
}

}  // namespace

SessionRollouts roll_out(const std::filesystem::path& session_folder,
                         const std::vector<SurrogateFactory>& surrogates,
                         const RolloutOptions& options) {
  const Recording recording(session_folder);
  const SessionInfo& info = recording.session.info();
  const double counts_per_turn = board_motor(info.board_name).counts_per_turn;
  const Assembly model =
      import_urdf(find_model_file(recording.experiment, info.board_name), UrdfOptions{});
  PlantOptions plant_options;
  plant_options.soil = recording.soil;
  plant_options.vehicle.motor = board_motor(info.board_name).motor;

  SessionRollouts result;
  result.source = info.experiment_name;
  result.by_surrogate.resize(surrogates.size());
  Robot firmware(info.board, info.parameters, info.credentials);
  RobotOutput output{};
  ImuModel imu(recording.experiment.experiment.seed, imu_errors(recording.experiment));
  ImuTruth at_rest{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), Eigen::Matrix3d::Identity(),
                   0.0};
  std::optional<DriveStrides> strides;
  std::optional<SinkageReplay> pressed;
  if (options.bearing != nullptr) {
    if (options.drive == RolloutDrive::kTracks) {
      throw InputError("rollouts: deformable ground needs --drive firmware");
    }
    pressed.emplace(strides.emplace(session_folder));
  }
  const std::uint64_t rows = recording.frames.size();
  const std::uint64_t begin = recording.first + 2;
  std::uint64_t next = begin;
  std::size_t started = 0;
  for (std::uint64_t row = 0; row < rows; ++row) {
    firmware.tick(recording.samples[row], output);
    SensorSample unused{};
    imu.measure(at_rest, unused);  // so that its generators stand where they stood
    if (row < next) continue;
    ++started;
    const std::uint64_t end = recording.end_of_rollout(row, options.max_frames);
    next = options.starts == 0 ? std::max(end - 1, row + 1)
                               : begin + (rows - begin) * started / options.starts;
    // A start from which not even the first distance is travelled gives no error.
    if (recording.distances[end - 1] - recording.distances[row] < kRolloutDistances_m[0]) continue;
    const HeightField ground = field_of(recording.session.heights_after(row + 1));
    std::optional<HeightField> sinkage;
    if (pressed.has_value()) sinkage = pressed->after(strides->ended_before(row + 1)).sinkage();
    for (std::size_t i = 0; i < surrogates.size(); ++i) {
      if (options.drive == RolloutDrive::kTracks) {
        result.by_surrogate[i].push_back(
            by_tracks(recording, row, end, ground, surrogates[i].robot()));
      } else {
        SurrogatePlant plant(ground, model, plant_options, surrogates[i].robot());
        if (sinkage.has_value()) plant.enable_deformation(options.bearing, &*sinkage);
        result.by_surrogate[i].push_back(
            by_firmware(recording, row, end, plant, firmware, output, imu, counts_per_turn));
      }
    }
    std::vector<PlanarPose> real;
    for (std::uint64_t at = row + kPathFrames; at < end; at += kPathFrames) {
      real.push_back(recording.poses[at]);
      if (recording.distances[at] - recording.distances[row] > kRolloutDistances_m.back()) break;
    }
    result.real.push_back(std::move(real));
  }
  return result;
}

Rollout divergence(const std::filesystem::path& session_folder,
                   const std::filesystem::path& other) {
  const Recording recording(session_folder);
  const Recording twin(other);
  const PlanarPose& begin = recording.poses[recording.first];
  const PlanarPose& twin_begin = twin.poses[twin.first];
  Checker checker(recording, recording.first);
  const std::uint64_t frames =
      std::min(recording.frames.size() - recording.first, twin.frames.size() - twin.first);
  for (std::uint64_t i = 1; i < frames; ++i) {
    PlanarPose pose = twin.poses[twin.first + i];
    pose.x_m += begin.x_m - twin_begin.x_m;
    pose.y_m += begin.y_m - twin_begin.y_m;
    pose.heading_rad += begin.heading_rad - twin_begin.heading_rad;
    if (!checker.add_row(recording.first + i, pose)) break;
  }
  return checker.take();
}

}  // namespace screed::nn
