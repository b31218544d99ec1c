#include "nn/terrain/drive_strides.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/experiment/run_setup.h"
#include "host_sim/run/session/export.h"
#include "host_sim/run/session/run_folder.h"
#include "host_sim/run/simulation/simulation.h"

namespace screed::nn {

std::array<WheelPosition, 4> wheel_positions(const Assembly& robot) {
  std::array<WheelPosition, 4> positions;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const AssemblyWheel& wheel = robot.wheels[i % 2][i / 2];
    positions[i] = {wheel.centre.x(), wheel.centre.y(), wheel.radius_m, i < 2};
  }
  return positions;
}

DriveStrides::DriveStrides(const std::filesystem::path& run) : session_(session_file(run)) {
  if (!session_.has_heights()) {
    throw InputError(run.string() +
                     ": the heights were not recorded; screed record and sim --heights keep them");
  }
  const RunSetup setup = setup_of(session_.info(), run);
  robot_ = robot_model(setup, session_.info().board_name);
  wheels_ = wheel_positions(robot_);
  tracks_ = setup.experiment.vehicle.tracks;
  const double tick_s = 1.0 / session_.info().tick_rate_hz;
  std::vector<SimFrame> frames(session_.frames());
  constexpr std::size_t kBlock = 1024;
  for (std::size_t at = 0; at < frames.size(); at += kBlock) {
    session_.read(at, std::span(frames).subspan(at, std::min(kBlock, frames.size() - at)));
  }
  constexpr std::int32_t kRunning = 2;
  while (first_frame_ < frames.size() && frames[first_frame_].state != kRunning) ++first_frame_;
  for (std::size_t begin = first_frame_; begin + kStrideFrames <= frames.size();
       begin += kStrideFrames) {
    Stride stride;
    double dx = 0.0;
    double dy = 0.0;
    for (std::size_t i = begin; i < begin + kStrideFrames; ++i) {
      dx += frames[i].delta_x;
      dy += frames[i].delta_y;
      stride.turn_rad += frames[i].delta_theta;
      stride.track_m[0] += frames[i].track_left * tick_s;
      stride.track_m[1] += frames[i].track_right * tick_s;
    }
    const SimFrame& end = frames[begin + kStrideFrames - 1];
    stride.x_m = end.x;
    stride.y_m = end.y;
    stride.yaw_rad = end.yaw;
    const auto [sine, cosine] = portable::sine_cosine(end.yaw);
    stride.forward_m = cosine * dx + sine * dy;
    stride.sideways_m = -sine * dx + cosine * dy;
    stride.v_left = end.v_left;
    stride.v_right = end.v_right;
    stride.pitch = end.pitch;
    stride.roll = end.roll;
    strides_.push_back(stride);
  }
  if (strides_.empty()) throw InputError(run.string() + ": the robot never ran");
}

HeightField DriveStrides::initial_terrain() const {
  return terrain_after(0);
}

HeightField DriveStrides::terrain_after(std::size_t strides) const {
  return field_of(session_.heights_after(first_frame_ + strides * kStrideFrames));
}

void DriveStrides::advance(std::size_t i, HeightField& ground) const {
  const HeightMap& after = session_.heights_after(first_frame_ + (i + 1) * kStrideFrames);
  const auto nodes_x = static_cast<std::size_t>(ground.nx());
  for (std::size_t node = 0; node < after.heights.size(); ++node) {
    if (after.heights[node] == ground.node(node)) continue;
    ground.set_node(static_cast<int>(node % nodes_x), static_cast<int>(node / nodes_x),
                    after.heights[node]);
  }
}

}  // namespace screed::nn
