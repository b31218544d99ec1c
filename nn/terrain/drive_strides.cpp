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

// ---- comparison: heights, volume, ruts

namespace {

constexpr double kMillimetres = 1e3;
constexpr double kTouched_m = 0.0001;

/// Ruts of one cross-section of changes.
std::size_t ruts_of(const std::vector<double>& section) {
  constexpr double kMinRutDepth_m = 0.0002;
  const double deepest = -*std::min_element(section.begin(), section.end());
  if (deepest < kMinRutDepth_m) return 0;
  std::size_t ruts = 0;
  bool inside = false;
  for (const double change : section) {
    if (!inside && change < -deepest / 3.0) {
      inside = true;
      ++ruts;
    }
    if (inside && change > -deepest / 10.0) inside = false;
  }
  return ruts;
}

}  // namespace

TerrainComparison compare(const HeightField& before, const HeightField& real,
                          const HeightField& predicted) {
  TerrainComparison result;
  std::size_t touched = 0;
  std::size_t others = 0;
  double truth = 0.0;
  double error = 0.0;
  double outside = 0.0;
  double moved = 0.0;
  for (int iy = 0; iy < before.ny(); ++iy) {
    for (int ix = 0; ix < before.nx(); ++ix) {
      const double change =
          (static_cast<double>(real.node(ix, iy)) - before.node(ix, iy)) * kHeightUnit_m;
      const std::int64_t units = std::int64_t{predicted.node(ix, iy)} - before.node(ix, iy);
      const double guess = static_cast<double>(units) * kHeightUnit_m;
      result.volume_units += units;
      moved += std::max(0.0, -guess);
      if (std::abs(change) > kTouched_m) {
        ++touched;
        truth += change * change;
        error += (guess - change) * (guess - change);
      } else {
        ++others;
        outside += (guess - change) * (guess - change);
      }
    }
  }
  const double cell_m2 = before.spacing_m() * before.spacing_m();
  const auto rms_mm = [](double sum, std::size_t count) {
    return count == 0 ? 0.0 : std::sqrt(sum / static_cast<double>(count)) * kMillimetres;
  };
  constexpr double kCubicCentimetres = 1e6;
  result.touched_m2 = static_cast<double>(touched) * cell_m2;
  result.true_change_mm = rms_mm(truth, touched);
  result.error_mm = rms_mm(error, touched);
  result.outside_mm = rms_mm(outside, others);
  result.moved_cm3 = moved * cell_m2 * kCubicCentimetres;
  result.volume_cm3 =
      static_cast<double>(result.volume_units) * kHeightUnit_m * cell_m2 * kCubicCentimetres;
  return result;
}

RutCount count_ruts(const HeightField& before, const HeightField& after,
                    const std::vector<Stride>& path) {
  constexpr double kHalfWidth_m = 0.16;
  constexpr double kStep_m = 0.0025;
  constexpr double kEnds_m = 0.2;          // the robot is as long
  constexpr double kMaxTurn_rad = 0.0026;  // 3 degrees a second
  constexpr int kHalfLength = 2;           // cross-sections are means over 1 cm of the path
  double length = 0.0;
  for (const Stride& stride : path) length += std::abs(stride.forward_m);
  RutCount result;
  double at_m = 0.0;
  std::size_t sections = 0;
  for (const Stride& stride : path) {
    at_m += std::abs(stride.forward_m);
    if (at_m < kEnds_m || at_m > length - kEnds_m || std::abs(stride.turn_rad) > kMaxTurn_rad) {
      continue;
    }
    const auto [sine, cosine] = portable::sine_cosine(stride.yaw_rad);
    std::vector<double> section;
    const int half = static_cast<int>(kHalfWidth_m / kStep_m);
    for (int i = -half; i <= half; ++i) {
      double change = 0.0;
      for (int j = -kHalfLength; j <= kHalfLength; ++j) {
        const double x = stride.x_m + cosine * j * kStep_m - sine * i * kStep_m;
        const double y = stride.y_m + sine * j * kStep_m + cosine * i * kStep_m;
        change += after.at(x, y).height - before.at(x, y).height;
      }
      section.push_back(change / (2 * kHalfLength + 1));
    }
    const std::size_t ruts = ruts_of(section);
    if (result.histogram.size() <= ruts) result.histogram.resize(ruts + 1);
    ++result.histogram[ruts];
    result.mean += static_cast<double>(ruts);
    ++sections;
  }
  if (sections != 0) result.mean /= static_cast<double>(sections);
  return result;
}

}  // namespace screed::nn
