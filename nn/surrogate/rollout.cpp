#include "nn/surrogate/rollout.h"

#include <algorithm>

#include "host_sim/run/experiment/board_table.h"
#include "host_sim/run/experiment/robot_model.h"
#include "host_sim/run/session/export.h"
#include "host_sim/standin/coarse_ground.h"
#include "host_sim/standin/standin_plant.h"
#include "nn/surrogate/recorded_drive.h"
#include "nn/surrogate/rollout_robot.h"

namespace screed::nn {
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
