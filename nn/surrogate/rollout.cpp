#include "nn/surrogate/rollout.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "host_sim/core/constants.h"
#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"
#include "host_sim/run/experiment/board_table.h"
#include "host_sim/run/experiment/robot_model.h"
#include "host_sim/run/session/export.h"
#include "host_sim/run/world/world.h"
#include "host_sim/run/world/world_setup.h"
#include "host_sim/standin/coarse_ground.h"
#include "host_sim/standin/standin_plant.h"
#include "schema/values.h"

namespace screed::nn {
RecordedDrive::RecordedDrive(const std::filesystem::path& folder)
    : session(folder / "session.h5"), experiment(read_experiment(folder / "experiment.ini")) {
  if (!experiment.map.is_soil() || !session.has_heights()) {
    throw InputError(folder.string() +
                     ": rollouts need a session on soil (scm) with its heights, as screed "
                     "record makes it");
  }
  soil = make_soil(experiment);
  battery = make_battery(experiment, session.info().board_name);
  frames.resize(session.frames());
  samples.resize(session.frames());
  session.read(0, std::span(frames));
  session.read(0, std::span(samples));
  while (first < frames.size() &&
         frames[first].leveling_state !=
             static_cast<std::int32_t>(message::LevelingState::kTrainingDrive)) {
    ++first;
  }
  if (first + 3 >= frames.size()) {
    throw InputError(folder.string() + ": Algorithm 5 drove no frame of it");
  }
  PlanarPose pose{frames[0].x, frames[0].y, frames[0].yaw};
  double distance_m = 0.0;
  double charge_c = 0.0;
  double energy_j = 0.0;
  for (const SimFrame& frame : frames) {
    const double middle = pose.heading_rad + 0.5 * frame.delta_theta;
    const auto [s, c] = portable::sine_cosine(middle);
    motions.push_back({frame.delta_x * c + frame.delta_y * s, frame.delta_y * c - frame.delta_x * s,
                       frame.delta_theta});
    pose.move(motions.back());
    poses.push_back(pose);
    distance_m += portable::hypot(frame.delta_x, frame.delta_y);
    distances.push_back(distance_m);
    if (frame.battery > 0.0) charge_c += (frame.energy - energy_j) / frame.battery;
    energy_j = frame.energy;
    drawn_c.push_back(charge_c);
  }
}

std::uint64_t RecordedDrive::end_of_rollout(std::uint64_t row, double distance_m,
                                            std::uint64_t max_frames) const {
  const std::uint64_t last = std::min<std::uint64_t>(frames.size(), row + 1 + max_frames);
  std::uint64_t end = row + 1;
  while (end < last && distances[end - 1] - distances[row] < distance_m) ++end;
  return end;
}

DrivingState RecordedDrive::state(std::uint64_t row, double counts_per_turn) const {
  const SimFrame& frame = frames[row];
  DrivingState state;
  state.pose = poses[row];
  state.last = motions[row];
  state.track_speed_m_per_s = {frame.track_left, frame.track_right};
  const auto angle = [&](std::uint16_t count) {
    return (count + 0.5) / counts_per_turn * 2.0 * std::numbers::pi;
  };
  state.shaft_angle_rad = {angle(samples[row].encoder_left), angle(samples[row].encoder_right)};
  state.battery = battery;
  state.battery.terminal_v = frame.battery;
  state.battery.draw(drawn_c[row]);
  state.battery.energy_j = frame.energy;
  return state;
}

RolloutRobot::RolloutRobot(const SessionInfo& info, const Experiment& experiment)
    : firmware_(info.board, info.parameters, info.credentials),
      imu_(experiment.experiment.seed, experiment.sensors.imu_errors()),
      counts_per_turn_(board_motor(info.board_name).counts_per_turn),
      board_(info.board) {}

void RolloutRobot::follow(const SensorSample& recorded) {
  const ImuTruth at_rest{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
                         Eigen::Matrix3d::Identity(), 0.0};
  firmware_.tick(recorded, output_);
  SensorSample unused{};
  imu_.measure(at_rest, unused);  // so that its generators stand where they stood
}

SensorSample RolloutRobot::measure(const RobotView& robot, const SensorSample& recorded) {
  SensorSample sample = recorded;
  imu_.measure(robot.motion(), sample);
  measure_drive(robot, counts_per_turn_, board_, sample);
  return sample;
}

void RolloutRobot::tick(const RobotView& robot, const SensorSample& recorded) {
  firmware_.tick(measure(robot, recorded), output_);
}

std::array<double, 2> RolloutRobot::duty_ratio() const {
  return {static_cast<double>(output_.duty_left) / kDutyMax,
          static_cast<double>(output_.duty_right) / kDutyMax};
}

void StandardDeviation::add(double value) {
  count_ += 1.0;
  sum_ += value;
  squares_ += value * value;
}

double StandardDeviation::deviation() const {
  if (count_ == 0.0) return 0.0;
  const double mean = sum_ / count_;
  return std::sqrt(std::max(0.0, squares_ / count_ - mean * mean));
}

RolloutChecker::RolloutChecker(const RecordedDrive& recording, std::uint64_t start)
    : recording_(recording), heading_rad_(recording.poses[start].heading_rad) {
  rollout_.start = start;
}

void RolloutChecker::add_row(std::uint64_t row, const PlanarPose& pose) {
  if ((row - rollout_.start) % kPathFrames == 0) rollout_.path.push_back(pose);
  if (recording_.frames[row].angular != 0.0) straight_ = false;
  yaw_rates_.add((pose.heading_rad - heading_rad_) / kTick_s);
  recorded_yaw_rates_.add(recording_.motions[row].turn_rad / kTick_s);
  heading_rad_ = pose.heading_rad;
  const double distance = recording_.distances[row] - recording_.distances[rollout_.start];
  while (next_ < kRolloutDistances_m.size() && distance >= kRolloutDistances_m.at(next_)) {
    const PlanarPose& real = recording_.poses[row];
    rollout_.checks.at(next_) = {
        true, straight_,
        portable::hypot(pose.x_m - real.x_m, pose.y_m - real.y_m) / kRolloutDistances_m.at(next_),
        std::abs(pose.heading_rad - real.heading_rad)};
    ++next_;
  }
}

Rollout RolloutChecker::take() {
  rollout_.yaw_rate_deviation_rad_per_s = yaw_rates_.deviation();
  rollout_.recorded_yaw_rate_deviation_rad_per_s = recorded_yaw_rates_.deviation();
  return std::move(rollout_);
}

namespace {

Rollout by_tracks(const RecordedDrive& recording, std::uint64_t start, std::uint64_t end,
                  const HeightField& ground, Surrogate robot) {
  robot.set_pose(0, recording.poses[start], recording.motions[start]);
  RolloutChecker checker(recording, start);
  for (std::uint64_t row = start + 1; row < end; ++row) {
    const SimFrame& frame = recording.frames[row];
    robot.step(ground, {&frame.track_left, 1}, {&frame.track_right, 1});
    checker.add_row(row, robot.pose(0));
  }
  return checker.take();
}

Rollout by_tracks(const RecordedDrive& recording, std::uint64_t start, std::uint64_t end,
                  StandInPlant& plant) {
  RolloutChecker checker(recording, start);
  for (std::uint64_t row = start + 1; row < end; ++row) {
    const SimFrame& frame = recording.frames[row];
    plant.step_frame({frame.track_left, frame.track_right});
    checker.add_row(row, plant.pose());
  }
  return checker.take();
}

template <typename Plant>
Rollout by_firmware(const RecordedDrive& recording, std::uint64_t start, std::uint64_t end,
                    Plant& plant, RolloutRobot robot) {
  plant.set_state(recording.state(start, robot.counts_per_turn()));
  RolloutChecker checker(recording, start);
  for (std::uint64_t row = start + 1; row < end; ++row) {
    const DutyRatio duty = robot.duty_ratio();
    for (int i = 0; i < plant.steps_per_tick(); ++i) plant.step({&duty, 1});
    checker.add_row(row, plant.pose());
    robot.tick(plant.robot(0), recording.samples[row]);
  }
  return checker.take();
}

}  // namespace

SessionRollouts roll_out(const std::filesystem::path& session_folder,
                         const std::vector<SurrogateFactory>& surrogates,
                         const RolloutOptions& options) {
  const RecordedDrive recording(session_folder);
  const SessionInfo& info = recording.session.info();
  const Assembly model = make_robot_model(recording.experiment, info.board_name);
  PlantOptions plant_options;
  plant_options.soil = recording.soil;
  plant_options.vehicle.motor = board_motor(info.board_name).motor;
  plant_options.battery = recording.battery;
  plant_options.vehicle.tracks = recording.experiment.vehicle.tracks;

  SessionRollouts result;
  result.source = info.experiment_name;
  result.by_surrogate.resize(surrogates.size());
  RolloutRobot robot(info, recording.experiment);
  const std::uint64_t rows = recording.frames.size();
  const std::uint64_t begin = recording.first + 2;
  std::uint64_t next = begin;
  std::size_t started = 0;
  for (std::uint64_t row = 0; row < rows; ++row) {
    robot.follow(recording.samples[row]);
    if (row < next) continue;
    ++started;
    const std::uint64_t end =
        recording.end_of_rollout(row, kRolloutDistances_m.back(), options.max_frames);
    next = options.starts == 0 ? end - 1 : begin + (rows - begin) * started / options.starts;
    // A start from which not even the first distance is travelled gives no error.
    if (recording.distances[end - 1] - recording.distances[row] < kRolloutDistances_m[0]) continue;
    const HeightField ground = field_of(recording.session.heights_after(row + 1));
    for (std::size_t i = 0; i < surrogates.size(); ++i) {
      report_progress(options.progress, "rolling out", row * surrogates.size() + (end - row) * i,
                      rows * surrogates.size());
      if (!surrogates[i].robot) {
        plant_options.starts[0].x_m = recording.poses[row].x_m;
        plant_options.starts[0].y_m = recording.poses[row].y_m;
        plant_options.starts[0].attitude.heading = recording.poses[row].heading_rad;
        StandInPlant plant(coarse_ground(ground, kStandInCell_m), model, plant_options);
        if (options.drive == RolloutDrive::kTracks) {
          plant.set_state(recording.state(row, robot.counts_per_turn()));
          result.by_surrogate[i].push_back(by_tracks(recording, row, end, plant));
        } else {
          result.by_surrogate[i].push_back(by_firmware(recording, row, end, plant, robot));
        }
      } else if (options.drive == RolloutDrive::kTracks) {
        result.by_surrogate[i].push_back(
            by_tracks(recording, row, end, ground, surrogates[i].robot()));
      } else {
        SurrogatePlant plant(ground, model, plant_options, surrogates[i].robot());
        result.by_surrogate[i].push_back(by_firmware(recording, row, end, plant, robot));
      }
    }
    std::vector<PlanarPose> real;
    for (std::uint64_t at = row + kPathFrames; at < end; at += kPathFrames) {
      real.push_back(recording.poses[at]);
    }
    result.starts.push_back(recording.poses[row]);
    result.real.push_back(std::move(real));
  }
  return result;
}

Rollout divergence(const std::filesystem::path& session_folder,
                   const std::filesystem::path& other) {
  const RecordedDrive recording(session_folder);
  const RecordedDrive twin(other);
  const PlanarPose& begin = recording.poses[recording.first];
  const PlanarPose& twin_begin = twin.poses[twin.first];
  RolloutChecker checker(recording, recording.first);
  const std::uint64_t end = recording.end_of_rollout(recording.first, kRolloutDistances_m.back(),
                                                     twin.frames.size() - twin.first - 1);
  for (std::uint64_t row = recording.first + 1; row < end; ++row) {
    PlanarPose pose = twin.poses[twin.first + row - recording.first];
    pose.x_m += begin.x_m - twin_begin.x_m;
    pose.y_m += begin.y_m - twin_begin.y_m;
    pose.heading_rad += begin.heading_rad - twin_begin.heading_rad;
    checker.add_row(row, pose);
  }
  return checker.take();
}

}  // namespace screed::nn
