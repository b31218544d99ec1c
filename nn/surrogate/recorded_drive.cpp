#include "nn/surrogate/recorded_drive.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"
#include "host_sim/run/experiment/robot_model.h"
#include "host_sim/run/world/world_setup.h"
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

}  // namespace screed::nn
